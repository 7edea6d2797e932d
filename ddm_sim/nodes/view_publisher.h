// Publishes camera data for people and tools: a large image, camera_info, tf.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_plant_plugin/image_message.h>
#include <geometry_msgs/TransformStamped.h>
#include <image_transport/image_transport.h>
#include <ros/console.h>
#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <Eigen/Geometry>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_msgs/topics.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// Message of a pinhole camera without distortion, in its optical frame; without a stamp.
///
///   f = height / 2 / tan(fovy / 2),   c = ((width - 1) / 2, (height - 1) / 2)
///
/// The offset of 1/2 pixel follows from the convention that the first pixel has its centre at
/// (0, 0).
inline sensor_msgs::CameraInfo cameraInfoOf(const CameraModel& camera) {
  const double f = camera.focalLength();
  const double cx = 0.5 * (camera.width - 1);
  const double cy = 0.5 * (camera.height - 1);
  sensor_msgs::CameraInfo info;
  info.header.frame_id = opticalFrame(camera);
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// Pose of the optical frame in the frame "world"; without a stamp.
/// @pre the camera is fixed
inline geometry_msgs::TransformStamped opticalFrameOf(const CameraModel& camera) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(camera.rotation).normalized();
  geometry_msgs::TransformStamped frame;
  frame.header.frame_id = "world";
  frame.child_frame_id = opticalFrame(camera);
  frame.transform.translation.x = camera.position.x();
  frame.transform.translation.y = camera.position.y();
  frame.transform.translation.z = camera.position.z();
  frame.transform.rotation.x = rotation.x();
  frame.transform.rotation.y = rotation.y();
  frame.transform.rotation.z = rotation.z();
  frame.transform.rotation.w = rotation.w();
  return frame;
}

/// Renders the view only while a node subscribes, because the view costs many times more than the
/// learner's image. If the plant has no view, the camera image is published instead. A plant
/// without a pinhole camera has no camera_info and no tf frame.
class ViewPublisher {
 public:
  /// @param nh     node handle whose namespace contains the topics
  /// @param plant  must outlive this object
  ViewPublisher(ros::NodeHandle nh, const Plant& plant)
      : plant_(plant), has_view_(plant.viewModel().has_value()) {
    std::vector<geometry_msgs::TransformStamped> frames;
    const auto announce = [&](const std::optional<CameraModel>& camera, const char* topic) {
      if (!camera) return;
      infos_.push_back(
          {nh.advertise<sensor_msgs::CameraInfo>(topic, kViewQueueSize, /*latch=*/true),
           cameraInfoOf(*camera)});
      infos_.back().publisher.publish(infos_.back().message);
      const bool known = !frames.empty() && frames.front().child_frame_id == opticalFrame(camera);
      if (camera->fixed && !known) frames.push_back(opticalFrameOf(*camera));
    };
    announce(plant.cameraModel(), topics::kImageInfo);
    announce(plant.viewModel(), topics::kViewInfo);
    frame_ = opticalFrame(has_view_ ? plant.viewModel() : plant.cameraModel());
    if (!frames.empty()) tf_.emplace().sendTransform(frames);
    view_ = image_transport::ImageTransport(nh).advertise(topics::kView, kViewQueueSize);
  }

  /// Publishes the view of the current state, and camera_info with the stamp of the image for nodes
  /// that subscribe to it. If the view cannot be rendered, the node stops publishing views and the
  /// episode continues.
  /// @param captured  image of the camera, for plants without a view
  void publish(const RenderedImage& captured, const ros::Time& stamp) {
    for (Info& info : infos_) info.publish(stamp);
    if (view_.getNumSubscribers() == 0) return;
    try {
      const RenderedImage view = has_view_ ? plant_.view(plant_.state()) : captured;
      view_.publish(imageMessage(view, stamp, frame_));
    } catch (const std::runtime_error& e) {
      ROS_ERROR_STREAM("no more images for people: " << e.what());
      view_.shutdown();
    }
  }

 private:
  /// camera_info of one camera.
  struct Info {
    ros::Publisher publisher;
    sensor_msgs::CameraInfo message;

    void publish(const ros::Time& stamp) {
      if (publisher.getNumSubscribers() == 0) return;
      message.header.stamp = stamp;
      publisher.publish(message);
    }
  };

  // The queue is short because views are large and an old view is useless.
  static constexpr int kViewQueueSize = 2;

  const Plant& plant_;
  bool has_view_;
  std::string frame_;  ///< tf frame of the view
  std::vector<Info> infos_;
  image_transport::Publisher view_;
  std::optional<tf2_ros::StaticTransformBroadcaster> tf_;  ///< empty if no camera is fixed
};

}  // namespace ddm
