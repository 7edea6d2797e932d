// Epsilon-greedy exploration around a policy.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <random>

#include "ddm_mpc/policy.h"

namespace ddm {

/// What was decided for one image.
struct Decision {
  Eigen::VectorXd torque;               ///< u_t [N m]                     [torque_dim]
  bool exploratory = false;             ///< a random torque
  std::optional<double> solve_time;     ///< see Answer; empty where exploratory [s]
  std::optional<Plan> plan;             ///< of a policy that plans; empty where exploratory
  std::optional<double> goal_distance;  ///< see Policy::goalDistance()
};

/// With probability epsilon a random torque, otherwise the policy's answer (paper, Sec. 3.2). epsilon
/// = 1 is the random trial, 0 the greedy one. A random torque is uniform in +-max_torque and held for
/// hold_steps steps. Exploration has a random stream of its own.
class EpsilonGreedy {
 public:
  struct Options {
    double epsilon = 0.2;  ///< [-]
    int hold_steps = 1;    ///< how long a random torque is held [-]
    Eigen::VectorXd max_torque = Eigen::VectorXd::Constant(1, 6.0);  ///< of each motor [N m]
  };

  /// @param policy  may be null where epsilon = 1
  /// @throws std::invalid_argument if options are out of range or the policy is missing
  EpsilonGreedy(std::shared_ptr<Policy> policy, const Options& options, const TrialId& id);

  /// Another probability from the next image on; a torque that is being held is held to its end.
  /// @throws std::invalid_argument if it is out of range, or < 1 where there is no policy
  void setEpsilon(double epsilon);

  /// See Policy::setGoal().
  void setGoal(const Grey& goal);

  /// Another torque acted than the last one decided. To be called before the next decide().
  /// @param torque  [N m]                                                          [torque_dim]
  /// @throws std::invalid_argument if it is not one finite number for each motor
  void correctTorque(const Eigen::VectorXd& torque);

  /// See Policy::startSegment(). To be called before the next decide().
  void startSegment();

  /// @param grey  the image just seen
  /// @throws std::invalid_argument for a wrong number of pixels
  Decision decide(const Grey& grey);

 private:
  std::shared_ptr<Policy> policy_;
  Options options_;
  std::mt19937_64 rng_;
  std::optional<Eigen::VectorXd> acted_;  // between the last image and the next; empty: unknown
  Eigen::VectorXd held_torque_;
  int held_steps_left_ = 0;
};

}  // namespace ddm
