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

/// What a policy answers an image with.
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

/// Called in turn for each frame: observe(y_t), answer() unless something else decides, apply(u_t).
/// apply() comes before the next observe(), when it is known which torque acted.
class Policy {
 public:
  virtual ~Policy() = default;

  /// Forgets the last trial.
  virtual void startTrial(const TrialId& id) = 0;

  /// Another goal than that of the data, from the next answer on. Ignored by those who have learned
  /// to reach one goal, or know the true one.
  /// @throws std::invalid_argument for a wrong number of pixels
  virtual void setGoal(const Grey& /*goal*/) {}

  /// The next image does not follow the last one by a time step, or no single torque acted between
  /// them: no state may be made from both, as in training. Ignored by policies without a memory.
  virtual void startSegment() {}

  /// Whether random torques are wanted too: only then may a policy go where it knows little.
  virtual void setExploring(bool /*exploring*/) {}

  /// Takes in the image just seen.
  /// @throws std::invalid_argument for a wrong number of pixels
  virtual void observe(const Grey& grey) = 0;

  /// Distance of the image just seen to the goal, in units that mean the same for every model;
  /// nothing where the policy knows none.
  virtual std::optional<double> goalDistance() const { return std::nullopt; }

  /// Decides u_t, the torque that answers the image just seen.
  virtual Answer answer() = 0;

  /// Takes in the torque [N m] that was applied, whoever decided it.
  virtual void apply(const Eigen::VectorXd& u) = 0;
};

}  // namespace ddm
