// Tests of sim_node with the moving tile: two torques, two joints, no rates.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <memory>

#include "ddm_sim/moving_tile.h"
#include "sim_client.h"

namespace ddm {
namespace {

std::unique_ptr<Plant> tile() {
  MovingTileOptions options;
  options.max_torque = {5.0};
  options.start_std = {5.0};
  return std::make_unique<MovingTile>(options);
}

std::vector<double> toVector(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

using LockstepTile = SimNodeTest;

TEST_F(LockstepTile, ShowsTheGoalStateOnTheGoalImage) {
  ASSERT_TRUE(client_->waitUntil([] { return !client_->goals.empty(); }));
  EXPECT_EQ(client_->goals[0].data, tile()->render(tile()->goal()).bytes);
}

TEST_F(LockstepTile, MovesTheTileAsTheLibraryDoesAndTellsTheTruthOfEachImage) {
  const auto plant = tile();
  plant->setState(Eigen::Vector2d(44.25, 6.0));
  ASSERT_TRUE(client_->reset(4, {44.25, 6.0}).success);
  // The first one bounces off the right border, the second one saturates.
  const std::vector<Eigen::Vector2d> torques{{4.0, -0.5}, {-100.0, 2.0}, {1.0, 0.0}};
  Eigen::VectorXd applied = Eigen::Vector2d::Zero();
  for (std::size_t t = 0; t < 4; ++t) {
    ASSERT_TRUE(client_->waitForImages(t + 1));
    const sensor_msgs::JointState& truth = client_->truths[t];
    const sensor_msgs::Image& image = client_->images[t];
    EXPECT_EQ(truth.header.stamp, image.header.stamp);
    EXPECT_EQ(truth.name, (std::vector<std::string>{"x", "y"}));
    EXPECT_EQ(truth.position, toVector(plant->state()));
    EXPECT_TRUE(truth.velocity.empty());
    EXPECT_EQ(truth.effort, toVector(applied));
    EXPECT_EQ(image.data, plant->render(plant->state()).bytes);
    if (t == 3) break;
    client_->publish(image.header.stamp, toVector(torques[t]));
    applied = plant->step(torques[t]);
  }
  EXPECT_EQ(plant->state(), Eigen::Vector2d(40.75, 7.5));
}

/// The launch file asks for 100 frames a second.
TEST_F(LockstepTile, ShowsNoMoreFramesInASecondThanItsRate) {
  ASSERT_TRUE(client_->reset(21).success);
  ASSERT_TRUE(client_->waitForImages(1));
  const ros::WallTime first = ros::WallTime::now();
  for (std::size_t t = 0; t < 20; ++t) {
    client_->publish(client_->images[t].header.stamp, {0.0, 0.0});
    ASSERT_TRUE(client_->waitForImages(t + 2));
  }
  EXPECT_GT((ros::WallTime::now() - first).toSec(), 0.17);  // two of 20 periods for the test itself
}

TEST_F(LockstepTile, DrawsTheStartThatTheLibraryDraws) {
  const auto plant = tile();
  std::mt19937_64 engine = startStream(7, 3, false);
  ASSERT_TRUE(client_->reset(0, {}, /*seed=*/7, /*trial=*/3).success);
  ASSERT_TRUE(client_->waitForImages(1));
  EXPECT_EQ(client_->truths[0].position, toVector(plant->drawStart(engine)));
}

TEST_F(LockstepTile, RefusesATorqueOfOneNumberAndSaysWhichItWants) {
  const ddm_msgs::Reset::Response response = client_->reset(0, {20.0, 20.0});
  ASSERT_TRUE(client_->waitForImages(1));
  client_->publish(response.start, {1.0});
  EXPECT_TRUE(client_->waitForLog("2 finite"));
  EXPECT_TRUE(client_->logged("dx_px dy_px"));
  EXPECT_TRUE(client_->waitForLog("trial 0 ends"));
}

}  // namespace
}  // namespace ddm
