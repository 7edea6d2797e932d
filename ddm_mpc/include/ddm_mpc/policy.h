// Interface of a policy, which answers each image with a torque.
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
  Eigen::VectorXd torque;    ///< u_t [N m]; 0 if the policy found none  [torque_dim]
  double solve_time = 0.0;   ///< wall time of the decision [s]
  std::optional<Plan> plan;  ///< plan whose first torque this is; empty: the policy does not plan
};

/// Makes the answer of a policy that plans.
inline Answer answerWith(Plan plan) {
  Answer answer;
  answer.torque = plan.torques.col(0);
  answer.solve_time = plan.solve_time;
  answer.plan = std::move(plan);
  return answer;
}

/// A policy decides torques. For each image, the caller calls observe(y_t); then answer(), unless
/// it chooses a random torque; and, before the next observe(), apply(u_t) with the torque that
/// acted.
class Policy {
 public:
  virtual ~Policy() = default;

  /// Clears the state of the last trial.
  virtual void startTrial(const TrialId& id) = 0;

  /// Sets a new goal from the next answer on, in place of the goal image of the data. A policy
  /// ignores it if it has learned to reach one goal, or if it reads the true goal from the plant.
  /// @throws std::invalid_argument for a wrong number of pixels
  virtual void setGoal(const Image& /*goal*/) {}

  /// Begins a new segment: the next image does not follow the last one by one time step, or no
  /// single torque acted between them. As in training, no controller state may then contain both
  /// images. Policies without a state ignore it.
  virtual void startSegment() {}

  /// Tells whether epsilon > 0. Only then may a policy lead to states with little data.
  virtual void setExploring(bool /*exploring*/) {}

  /// Adds the newest image.
  /// @throws std::invalid_argument for a wrong number of pixels
  virtual void observe(const Image& image) = 0;

  /// @return distance of the last image to the goal, in units that are comparable between models.
  ///         Empty if the policy has no such distance
  virtual std::optional<double> goalDistance() const { return std::nullopt; }

  /// Decides u_t, the torque that answers the newest image.
  virtual Answer answer() = 0;

  /// Adds the torque that was applied, whether or not the policy decided it [N m]  [torque_dim]
  virtual void apply(const Eigen::VectorXd& u) = 0;
};

}  // namespace ddm
