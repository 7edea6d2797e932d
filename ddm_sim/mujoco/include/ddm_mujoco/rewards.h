// Rewards of the DeepMind Control Suite, by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

/// Inputs of the reward of one physics step.
struct RewardInputs {
  Eigen::VectorXd state;    ///< state after the physics step: positions, then rates
  Eigen::VectorXd control;  ///< torques of the step, divided by the motors' limits, in [-1, 1]
  Eigen::VectorXd goal;     ///< state to reach
};

/// A reward function and the dimensions of the plant that it is made for.
struct Reward {
  std::string name;
  int num_joints;
  int num_motors;
  double (*value)(const RewardInputs&);  ///< in [0, 1]
};

/// Rewards of these tasks of the DeepMind Control Suite: pendulum_swingup, cartpole_smooth,
/// reacher_easy, reacher_hard, acrobot_smooth. The state has the order of the suite's models. The
/// target of the reacher is the position of the finger in the goal state.
const std::vector<Reward>& rewards();

}  // namespace ddm
