// Tests of the camera's disturbances through sim_node, in lock-step and in real time.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "ddm_sim/camera.h"
#include "ddm_sim/pendulum.h"
#include "sim_client.h"

namespace ddm {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr std::uint32_t kTrial = 3;
const std::vector<double> kStart{0.3, 5.0};

/// Plant and camera with the parameters of the launch file.
class CameraNode : public ::testing::Test {
 protected:
  CameraNode() {
    const ros::NodeHandle sim("sim_node");
    sim.getParam("plant/dt", plant_options_.dt);
    sim.getParam("camera/noise_std", camera_options_.noise_std);
    sim.getParam("camera/brightness_drift", camera_options_.brightness_drift);
    sim.getParam("camera/clutter", camera_options_.clutter);
    sim.getParam("camera/delay", camera_options_.delay);
    sim.getParam("camera/drop_rate", camera_options_.drop_rate);
    plant_ = std::make_unique<Pendulum>(plant_options_);
    plant_->setState(Eigen::Vector2d(kStart[0], kStart[1]));
    camera_ = std::make_unique<Camera>(camera_options_, plant_options_.dt);
    camera_->begin(kSeed, kTrial, false);
  }

  void SetUp() override {
    ASSERT_GT(camera_options_.drop_rate, 0.0);
    ASSERT_TRUE(client_.connect());
    client_.forget();
  }

  /// Expects that ground truth and image number `index` equal the results of the library in this
  /// step.
  void expectFrame(std::size_t index, const Picture& photograph) {
    EXPECT_EQ(client_.images[index].data, photograph.bytes) << index;
    EXPECT_EQ(client_.truths[index].header.stamp, client_.images[index].header.stamp) << index;
    EXPECT_EQ(client_.truths[index].position, std::vector<double>{plant_->state()[0]}) << index;
  }

  /// The camera image of the current state; empty if the image is lost.
  std::optional<Picture> photograph() {
    return camera_->photograph(plant_->render(plant_->state()));
  }

  PendulumOptions plant_options_;
  CameraOptions camera_options_;
  std::unique_ptr<Plant> plant_;
  std::unique_ptr<Camera> camera_;
  SimClient client_;
};

using LockstepCamera = CameraNode;
using RealtimeCamera = CameraNode;

TEST_F(LockstepCamera, ShowsTheFramesOfTheLibraryAndGoesOnUnderTheLastTorqueWhereOneIsLost) {
  constexpr std::size_t kFrames = 40;
  ASSERT_TRUE(client_.waitUntil([this] { return !client_.goals.empty(); }));
  EXPECT_EQ(client_.goals[0].data, camera_->photographGoal(plant_->render(plant_->goal())).bytes);
  const ros::Time start = client_.reset(kFrames, kStart, kSeed, kTrial).start;
  const ros::WallTime begin = ros::WallTime::now();
  std::uint64_t step = 0;
  auto seen = photograph();
  for (std::size_t t = 0; t < kFrames; ++t) {
    ASSERT_TRUE(client_.waitForImages(t + 1));
    const ros::Time stamp = client_.images[t].header.stamp;
    EXPECT_EQ(stamp.toNSec(), start.toNSec() + step * 200000000ULL) << t;
    expectFrame(t, *seen);
    const double torque = t % 2 == 0 ? 4.0 : -1.0;
    client_.publish(stamp, {torque});
    do {
      plant_->step(Eigen::VectorXd::Constant(1, torque));
      seen = photograph();
      ++step;
    } while (!seen);
  }
  EXPECT_GT(step, kFrames);
  // Counts only the images that were published.
  ASSERT_TRUE(client_.waitForLog("40 frames answered"));
  EXPECT_EQ(client_.images.size(), kFrames);
  // At 100 images per second; the test itself may be late in two periods.
  EXPECT_GT((ros::WallTime::now() - begin).toSec(), 0.37);
}

TEST_F(RealtimeCamera, ShowsTheFramesOfTheLibraryAndNothingWhereOneIsLost) {
  constexpr std::size_t kFrames = 20;
  const ros::Time start = client_.reset(0, kStart, kSeed, kTrial).start;
  // Each list is handled by itself, because one topic may have been connected before the other.
  const auto dropEarlier = [&start](auto* messages) {
    const auto isEarlier = [&start](const auto& message) { return message.header.stamp < start; };
    messages->erase(std::remove_if(messages->begin(), messages->end(), isEarlier), messages->end());
    return messages->size() >= kFrames;
  };
  ASSERT_TRUE(client_.waitUntil([&] {
    const bool all_images = dropEarlier(&client_.images);
    return dropEarlier(&client_.truths) && all_images;
  }));
  int num_lost = 0;
  for (std::size_t t = 0; t < kFrames;) {
    if (const auto seen = photograph()) {
      expectFrame(t++, *seen);
    } else {
      ++num_lost;
    }
    plant_->step(Eigen::VectorXd::Zero(1));  // because no node publishes a torque
  }
  EXPECT_GT(num_lost, 0);
}

}  // namespace
}  // namespace ddm
