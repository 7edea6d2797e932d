// Implements the rewards of the DeepMind Control Suite.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/rewards.h"

#include <algorithm>
#include <cmath>

#include "ddm_sim/plant.h"

namespace ddm {
namespace {

/// Equation: r(x) = 0.1^(d^2),   d = max(0, |x| - bound) / margin.
double tolerance(double x, double bound, double margin) {
  const double d = std::max(0.0, std::abs(x) - bound) / margin;
  return std::pow(0.1, d * d);
}

double pendulumSwingup(const RewardInputs& in) {
  return std::cos(in.state[0]) >= std::cos(8.0 * kPi / 180.0) ? 1.0 : 0.0;
}

double cartpoleSmooth(const RewardInputs& in) {
  const double x = in.state[0], angle = in.state[1], rate = in.state[3], u = in.control[0];
  const double upright = (1.0 + std::cos(angle)) / 2.0;
  const double small_control = (4.0 + std::max(0.0, 1.0 - u * u)) / 5.0;
  const double slow = (1.0 + tolerance(rate, 0.0, 5.0)) / 2.0;
  const double centred = (1.0 + tolerance(x, 0.0, 2.0)) / 2.0;
  return upright * small_control * slow * centred;
}

/// Position of the reacher's finger, whose links are 0.12 m long [m].
Eigen::Vector2d finger(const Eigen::VectorXd& state) {
  const double first = state[0], second = state[0] + state[1];
  return 0.12 *
         Eigen::Vector2d(std::cos(first) + std::cos(second), std::sin(first) + std::sin(second));
}

/// 1 if the finger touches the target, else 0. The finger has a radius of 0.01 m, the target one of
/// kMillimetres [mm].
template <int kMillimetres>
double reacher(const RewardInputs& in) {
  const double reached = 1e-3 * kMillimetres + 0.01;
  return (finger(in.state) - finger(in.goal)).norm() <= reached ? 1.0 : 0.0;
}

/// Depends on the distance of the acrobot's tip to the point 2 m above its shoulder. Each link has
/// a length of 1 m.
double acrobotSmooth(const RewardInputs& in) {
  const double first = in.state[0], second = in.state[0] + in.state[1];
  const double distance =
      std::hypot(std::sin(first) + std::sin(second), 2.0 - std::cos(first) - std::cos(second));
  return tolerance(distance, 0.2, 1.0);
}

}  // namespace

const std::vector<Reward>& rewards() {
  static const std::vector<Reward> all = {{"acrobot_smooth", 2, 1, acrobotSmooth},
                                          {"cartpole_smooth", 2, 1, cartpoleSmooth},
                                          {"pendulum_swingup", 1, 1, pendulumSwingup},
                                          {"reacher_easy", 2, 2, reacher<50>},
                                          {"reacher_hard", 2, 2, reacher<15>}};
  return all;
}

}  // namespace ddm
