// Tests of camera_info and of the tf frame of a camera.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "view_publisher.h"

namespace ddm {
namespace {

/// A camera with 640 x 480 pixels and a vertical field of view of 90 degrees at (1, 2, 3) that
/// looks along y: x of the image to the right, z up.
CameraModel sideways() {
  CameraModel camera;
  camera.name = "front";
  camera.width = 640;
  camera.height = 480;
  camera.fovy = 2.0 * std::atan(1.0);
  camera.fixed = true;
  camera.position = Eigen::Vector3d(1.0, 2.0, 3.0);
  camera.rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return camera;
}

TEST(CameraInfo, HasTheFocalLengthOfTheVerticalFieldOfView) {
  const sensor_msgs::CameraInfo info = cameraInfoOf(sideways());
  EXPECT_EQ(info.header.frame_id, "front_optical_frame");
  EXPECT_EQ(info.width, 640U);
  EXPECT_EQ(info.height, 480U);
  EXPECT_NEAR(info.K[0], 240.0, 1e-9);
  EXPECT_EQ(info.K[4], info.K[0]);
  EXPECT_EQ(info.P[0], info.K[0]);
  EXPECT_EQ(info.P[5], info.K[0]);
  EXPECT_EQ(info.K[8], 1.0);
  EXPECT_EQ(info.P[10], 1.0);
}

TEST(CameraInfo, SeesAPointAheadBetweenTheMiddlePixels) {
  const sensor_msgs::CameraInfo info = cameraInfoOf(sideways());
  EXPECT_EQ(info.K[2], 319.5);
  EXPECT_EQ(info.K[5], 239.5);
  EXPECT_EQ(info.P[2], 319.5);
  EXPECT_EQ(info.P[6], 239.5);
}

TEST(OpticalFrame, TurnsAheadIntoTheDirectionThatTheCameraLooksIn) {
  const geometry_msgs::TransformStamped frame = opticalFrameOf(sideways());
  EXPECT_EQ(frame.header.frame_id, "world");
  EXPECT_EQ(frame.child_frame_id, "front_optical_frame");
  EXPECT_EQ(frame.transform.translation.x, 1.0);
  EXPECT_EQ(frame.transform.translation.y, 2.0);
  EXPECT_EQ(frame.transform.translation.z, 3.0);
  const auto& q = frame.transform.rotation;
  const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
  EXPECT_TRUE((rotation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_TRUE((rotation * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE((rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitX(), 1e-12));
}

}  // namespace
}  // namespace ddm
