// Numbers of each plan, for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/PlanScalars.h>

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "ddm_mpc/planner.h"

namespace ddm {

/// Looks at the plans of a trial in turn: what one predicts, the next one finds to be so or not.
class PlanScalars {
 public:
  /// @param goal_distance  in units of the features' spread; empty: not known
  ddm_msgs::PlanScalars of(const ros::Time& stamp, const Plan& plan,
                           const std::optional<double>& goal_distance) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    ddm_msgs::PlanScalars out;
    out.header.stamp = stamp;
    out.goal_distance = goal_distance.value_or(kUnknown);
    out.prediction_error = kUnknown;
    out.cost = plan.cost;
    out.solve_time = plan.solve_time;
    if (plan.status == PlanStatus::kFailed) {
      forget();
      return out;
    }
    const Eigen::VectorXd z = plan.features.col(0);
    if (predicted_.size() > 0) out.prediction_error = (z - predicted_).norm();
    predicted_ = plan.features.col(1);
    return out;
  }

  /// The next image is not what the last plan was for.
  void forget() { predicted_.resize(0); }

 private:
  Eigen::VectorXd predicted_;  // z of the next image; empty: not known
};

}  // namespace ddm
