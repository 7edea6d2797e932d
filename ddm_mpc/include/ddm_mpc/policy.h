// A policy: which torque answers the image just seen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/random_stream.h>
#include <ddm_model/data_set.h>

#include <Eigen/Core>
#include <optional>
#include <utility>

#include "ddm_mpc/planner.h"

namespace ddm {

/// The answer of a policy to an image.
struct Answer {
  Eigen::VectorXd torque;    ///< u_t [N m]; 0 where the policy finds none  [torque_dim]
  double solve_time = 0.0;   ///< wall time that it took [s]
  std::optional<Plan> plan;  ///< of a policy that plans: torque is the first of it
};

/// The answer of a policy that plans.
inline Answer answerWith(Plan plan) {
  Answer answer;
  answer.torque = plan.torques.col(0);
  answer.solve_time = plan.solve_time;
  answer.plan = std::move(plan);
  return answer;
}

/// Decides torques. For each image, observe(y_t) is called first, then answer(), unless a random torque is
/// chosen, and then apply(u_t), before the next observe(), when it is known which torque acted.
class Policy {
 public:
  virtual ~Policy() = default;

  /// Forgets the last trial.
  virtual void startTrial(const TrialId& id) = 0;

  /// Sets another goal than that of the data, from the next answer on. Policies that have learned to reach
  /// one goal, or that read the true goal from the plant, ignore it.
  /// @throws std::invalid_argument for a wrong number of pixels
  virtual void setGoal(const Grey& /*goal*/) {}

  /// Says that the next image does not follow the last one by one time step, or that no single torque acted
  /// between them. As in training, no state may then contain both. Policies without a memory ignore it.
  virtual void startSegment() {}

  /// Says whether epsilon > 0. Only then may a policy lead to states of which little is known.
  virtual void setExploring(bool /*exploring*/) {}

  /// Takes in the image just seen.
  /// @throws std::invalid_argument for a wrong number of pixels
  virtual void observe(const Grey& grey) = 0;

  /// Distance of the last image to the goal, in units that mean the same for every model. Empty if the policy
  /// has no such distance.
  virtual std::optional<double> goalDistance() const { return std::nullopt; }

  /// Decides u_t, the torque that answers the image just seen.
  virtual Answer answer() = 0;

  /// Takes in the torque that was applied, also if another part decided it [N m].
  virtual void apply(const Eigen::VectorXd& u) = 0;
};

}  // namespace ddm
