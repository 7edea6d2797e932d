// Implements the simulation of a model under random torques.
// SPDX-License-Identifier: BSD-3-Clause
#include "random_motion.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mujoco_physics.h"

namespace ddm {
namespace {

using Eigen::VectorXd;

constexpr int kRuns = 8;
constexpr double kSeconds = 2.0;  // duration of a run [s]
constexpr double kHold = 0.3;     // time for which a random torque is constant [s]

}  // namespace

VectorXd atRest(const VectorXd& position) {
  VectorXd state = VectorXd::Zero(2 * position.size());
  state.head(position.size()) = position;
  return state;
}

double speedUnderRandomTorques(const std::shared_ptr<const MujocoModel>& model,
                               const Mechanism& mechanism, const MujocoOptions& options,
                               std::size_t num_motors, double share) {
  const MujocoPhysics physics(model, options);
  const int n = physics.numJoints();
  const double timestep = timestepOf(*model, options);
  const int hold = std::max(1, static_cast<int>(std::round(kHold / timestep)));
  std::vector<double> speeds;
  std::mt19937_64 engine(2);
  for (int run = 0; run < kRuns; ++run) {
    const std::vector<double>& pose = run % 2 == 0 ? options.start : options.goal;
    VectorXd state = atRest(Eigen::Map<const VectorXd>(pose.data(), n));
    for (double time = 0.0; time < kSeconds; time += hold * timestep) {
      VectorXd torque(static_cast<Eigen::Index>(num_motors));
      for (Eigen::Index i = 0; i < torque.size(); ++i) {
        const double limit = share * options.max_torque[static_cast<std::size_t>(i)];
        torque[i] = std::uniform_real_distribution<double>(-limit, limit)(engine);
      }
      const Eigen::MatrixXd states = physics.frames(state, torque, hold);
      for (Eigen::Index k = 0; k < states.cols(); ++k) {
        double fastest = 0.0;
        for (int i = 0; i < n; ++i) {
          fastest = std::max(fastest, std::abs(states(n + i, k)) / mechanism.unit(i));
        }
        speeds.push_back(fastest);
      }
      state = states.rightCols(1);
    }
  }
  std::sort(speeds.begin(), speeds.end());
  return speeds[speeds.size() * 95 / 100];
}

}  // namespace ddm
