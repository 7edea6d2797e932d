// Messages about plans: the plan itself, and its scalars for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Plan.h>
#include <ddm_msgs/PlanScalars.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "ddm_mpc/planner.h"

namespace ddm {

/// @return all entries, column by column
std::vector<double> flat(const Eigen::MatrixXd& values);

/// @param stamp  stamp of the image that the plan answers
ddm_msgs::Plan planMessage(const ros::Time& stamp, const Plan& plan);

/// Scalars of each plan of a trial. The prediction error is the distance between the feature of an
/// image and the prediction of that feature by the plan before it.
class PlanScalars {
 public:
  /// @param goal_distance  in units of the spread of the features; empty: unknown
  ddm_msgs::PlanScalars of(const ros::Time& stamp, const Plan& plan,
                           const std::optional<double>& goal_distance);

  /// Call if the next image does not follow the last plan by one time step.
  void forget() { predicted_.resize(0); }

 private:
  Eigen::VectorXd predicted_;  // predicted z of the next image; empty: unknown
};

}  // namespace ddm
