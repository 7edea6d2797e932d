// Numbers of each plan, for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#include "plan_scalars.h"

#include <limits>

namespace ddm {

ddm_msgs::PlanScalars PlanScalars::of(const ros::Time& stamp, const Plan& plan) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  ddm_msgs::PlanScalars out;
  out.header.stamp = stamp;
  out.goal_distance = out.prediction_error = kUnknown;
  out.cost = plan.cost;
  out.solve_time = plan.solve_time;
  if (plan.status == PlanStatus::kFailed) {
    forget();
    return out;
  }
  const Eigen::VectorXd z = plan.features.col(0);
  out.goal_distance = (z - plan.goal_feature).norm();
  if (predicted_.size() > 0) out.prediction_error = (z - predicted_).norm();
  predicted_ = plan.features.col(1);
  return out;
}

}  // namespace ddm
