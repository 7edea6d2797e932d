// Messages about plans: the plan itself, and its numbers for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Plan.h>
#include <ddm_msgs/PlanScalars.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "ddm_mpc/planner.h"

namespace ddm {

/// All entries, column by column.
std::vector<double> flat(const Eigen::MatrixXd& values);

/// @param stamp  of the image that the plan answers
ddm_msgs::Plan planMessage(const ros::Time& stamp, const Plan& plan);

/// Numbers about each plan of a trial. The prediction error compares the feature that the last plan predicted
/// with the feature of the next image.
class PlanScalars {
 public:
  /// @param goal_distance  in units of the features' spread; empty: not known
  ddm_msgs::PlanScalars of(const ros::Time& stamp, const Plan& plan,
                           const std::optional<double>& goal_distance);

  /// Says that the next image does not follow the last plan.
  void forget() { predicted_.resize(0); }

 private:
  Eigen::VectorXd predicted_;  // z of the next image; empty: not known
};

}  // namespace ddm
