// Test of the camera's nuisances over the wire, in real time.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>

#include "ddm_sim/camera.h"
#include "ddm_sim/pendulum.h"
#include "sim_client.h"

namespace ddm {
namespace {

/// Plant and camera are those that the launch file describes.
TEST(RealtimeCamera, ShowsTheFramesOfTheLibraryAndNothingWhereOneIsLost) {
  constexpr std::size_t kFrames = 20;
  const ros::NodeHandle sim("sim_node");
  PendulumOptions plant_options;
  CameraOptions camera_options;
  sim.getParam("plant/dt", plant_options.dt);
  sim.getParam("camera/noise_std", camera_options.noise_std);
  sim.getParam("camera/brightness_drift", camera_options.brightness_drift);
  sim.getParam("camera/clutter", camera_options.clutter);
  sim.getParam("camera/delay", camera_options.delay);
  sim.getParam("camera/drop_rate", camera_options.drop_rate);
  ASSERT_GT(camera_options.drop_rate, 0.0);
  Pendulum plant(plant_options);
  plant.setState(Eigen::Vector2d(0.3, 5.0));
  Camera camera(camera_options, plant_options.dt);
  camera.begin({/*seed=*/7, /*trial=*/3, false});

  SimClient client;
  ASSERT_TRUE(client.connect());
  client.forget();
  const ros::Time start = client.reset(0, {0.3, 5.0}, /*seed=*/7, /*trial=*/3).start;
  // each list by itself: of the frames before, one topic may have been connected earlier than the other
  const auto dropEarlier = [&start](auto* messages) {
    const auto isEarlier = [&start](const auto& message) { return message.header.stamp < start; };
    messages->erase(std::remove_if(messages->begin(), messages->end(), isEarlier), messages->end());
    return messages->size() >= kFrames;
  };
  ASSERT_TRUE(client.waitUntil([&] {
    const bool all_images = dropEarlier(&client.images);
    return dropEarlier(&client.truths) && all_images;
  }));
  int num_lost = 0;
  for (std::size_t t = 0; t < kFrames;) {
    if (const auto seen = camera.capture(plant.render(plant.state()))) {
      EXPECT_EQ(client.images[t].data, seen->bytes) << t;
      EXPECT_EQ(client.truths[t].header.stamp, client.images[t].header.stamp) << t;
      EXPECT_EQ(client.truths[t].position, std::vector<double>{plant.state()[0]}) << t;
      ++t;
    } else {
      ++num_lost;
    }
    plant.step(Eigen::VectorXd::Zero(1));  // nobody publishes a torque
  }
  EXPECT_GT(num_lost, 0);
}

}  // namespace
}  // namespace ddm
