// Messages about plans: the plan itself, and its scalars for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#include "plan_messages.h"

#include <limits>

namespace ddm {

static_assert(static_cast<int>(PlanStatus::kConverged) == ddm_msgs::Plan::CONVERGED &&
                  static_cast<int>(PlanStatus::kIterationLimit) ==
                      ddm_msgs::Plan::ITERATION_LIMIT &&
                  static_cast<int>(PlanStatus::kFailed) == ddm_msgs::Plan::FAILED &&
                  static_cast<int>(PlanStatus::kTimeLimit) == ddm_msgs::Plan::TIME_LIMIT,
              "a plan's status has the same number in both");

std::vector<double> flat(const Eigen::MatrixXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

ddm_msgs::Plan planMessage(const ros::Time& stamp, const Plan& plan) {
  ddm_msgs::Plan message;
  message.header.stamp = stamp;
  message.horizon = static_cast<std::uint32_t>(plan.torques.cols());
  message.torque = flat(plan.torques);
  message.feature = flat(plan.features);
  message.goal_feature = flat(plan.goal_feature);
  message.cost = plan.cost;
  message.iterations = plan.iterations;
  message.evaluations = plan.evaluations;
  message.status = static_cast<std::uint8_t>(plan.status);
  message.message = plan.message;
  message.solve_time = plan.solve_time;
  return message;
}

ddm_msgs::PlanScalars PlanScalars::of(const ros::Time& stamp, const Plan& plan,
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

}  // namespace ddm
