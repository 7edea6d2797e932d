// Test client of mpc_node: goals, images for them, and ears for all that it says.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib/client/simple_action_client.h>
#include <ddm_msgs/Plan.h>
#include <ddm_msgs/PlanScalars.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "node_client.h"

namespace ddm {

using Client = actionlib::SimpleActionClient<ddm_msgs::RunTrialAction>;
using State = actionlib::SimpleClientGoalState;

constexpr int kSize = 8;  // as in the files *.test

inline ddm_msgs::RunTrialGoal trialGoal(std::uint32_t num_steps, double epsilon,
                                        const std::string& model_id = "") {
  ddm_msgs::RunTrialGoal goal;
  goal.num_steps = num_steps;
  goal.epsilon = epsilon;
  goal.hold_steps = 1;
  goal.seed = 3;
  goal.model_id = model_id;
  return goal;
}

constexpr double kSpread = 0.5;  // of the features, in the models of modelOfSeed()

inline ddm_msgs::Model modelOfSeed(unsigned seed) {
  RandomModelOptions options;
  options.seed = seed;
  const Ddm model = randomModel(options);
  ModelInfo info = model.info();
  info.feature_spread = kSpread;
  return modelMessage(withInfo(model, info));
}

/// Runs trials of mpc_node.
class MpcNodeTest : public ::testing::Test {
 protected:
  explicit MpcNodeTest(const std::string& ns = "") : client_(ns) {}

  void SetUp() override {
    ASSERT_TRUE(waitUntil([this] {
      return action_.isServerConnected() && torque_.connected() && plan_.connected();
    }));
    ASSERT_TRUE(client_.connect());
  }

  void begin(const ddm_msgs::RunTrialGoal& goal) {
    action_.sendGoal(goal);
    ASSERT_TRUE(waitUntil([this] { return action_.getState() != State::PENDING; }));
  }

  /// Shows images until the trial has `num_steps` torques.
  void show(std::size_t num_steps) {
    while (torque_.messages.size() < num_steps) {
      stamps_.push_back(client_.publishImage(kSize, torque_.messages.size()));
      const std::size_t expected = torque_.messages.size() + 1;
      ASSERT_TRUE(waitUntil([&] { return torque_.messages.size() >= expected; }))
          << "no torque for step " << expected << ", " << action_.getState().getText();
    }
  }

  void expectEnd(State::StateEnum state, const std::vector<std::string>& parts_of_text = {}) {
    ASSERT_TRUE(waitUntil([this] { return action_.getState().isDone(); }));
    const std::string text = action_.getState().getText();
    EXPECT_EQ(action_.getState(), state) << action_.getState().toString() << ": " << text;
    for (const std::string& part : parts_of_text) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
    }
  }

  NodeClient client_;
  Listener<ddm_msgs::Torque> torque_{client_.nh, topics::kTorque};
  Listener<ddm_msgs::Plan> plan_{client_.nh, topics::kPlan};
  Client action_{client_.nh, topics::kRunTrial, /*spin_thread=*/false};
  std::vector<ros::Time> stamps_;
};

}  // namespace ddm
