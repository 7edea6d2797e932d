// Rewards of standard tasks, by name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

/// What the reward of one physics frame depends on.
struct RewardInputs {
  Eigen::VectorXd state;    ///< after the frame: positions, then rates
  Eigen::VectorXd control;  ///< that led to it, each torque by the motor's limit, in [-1, 1]
  Eigen::VectorXd goal;     ///< state to reach
};

/// A reward and the plant it is for.
struct Reward {
  std::string name;
  int num_joints;
  int num_motors;
  double (*value)(const RewardInputs&);  ///< in [0, 1]
};

/// The tasks of the DeepMind Control Suite: pendulum_swingup, cartpole_smooth,
/// reacher_easy, reacher_hard, acrobot_smooth. The state is that of the suite's
/// models; the target of the reacher is where the finger is at the goal.
const std::vector<Reward>& rewards();

}  // namespace ddm
