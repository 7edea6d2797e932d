// Messages about plans: the plan itself, and its scalars for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Plan.h>
#include <ddm_msgs/PlanScalars.h>

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "ddm_mpc/planner.h"

namespace ddm {

static_assert(static_cast<int>(PlanStatus::kConverged) == ddm_msgs::Plan::CONVERGED &&
                  static_cast<int>(PlanStatus::kIterationLimit) ==
                      ddm_msgs::Plan::ITERATION_LIMIT &&
                  static_cast<int>(PlanStatus::kFailed) == ddm_msgs::Plan::FAILED &&
                  static_cast<int>(PlanStatus::kTimeLimit) == ddm_msgs::Plan::TIME_LIMIT,
              "a plan's status has the same number in both");

/// @return all entries, column by column
inline std::vector<double> flat(const Eigen::MatrixXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

/// @param stamp  stamp of the image that the plan answers
inline ddm_msgs::Plan planMessage(const ros::Time& stamp, const Plan& plan) {
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

/// @param goal_distance  in units of the spread of the features; empty: unknown
/// @param predicted      feature that the plan before predicts for this image; empty: unknown
inline ddm_msgs::PlanScalars scalarsMessage(const ros::Time& stamp, const Plan& plan,
                                            const std::optional<double>& goal_distance,
                                            const Eigen::VectorXd& predicted) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const bool known = predicted.size() > 0 && plan.status != PlanStatus::kFailed;
  ddm_msgs::PlanScalars message;
  message.header.stamp = stamp;
  message.goal_distance = goal_distance.value_or(kUnknown);
  message.prediction_error = known ? (plan.features.col(0) - predicted).norm() : kUnknown;
  message.cost = plan.cost;
  message.solve_time = plan.solve_time;
  return message;
}

}  // namespace ddm
