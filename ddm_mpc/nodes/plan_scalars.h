// Numbers of each plan, for plotting tools.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/PlanScalars.h>

#include <Eigen/Core>

#include "ddm_mpc/planner.h"

namespace ddm {

/// Looks at the plans of a trial in turn: what one predicts, the next one finds to be so or not.
class PlanScalars {
 public:
  ddm_msgs::PlanScalars of(const ros::Time& stamp, const Plan& plan);

  /// The next image is not what the last plan was for.
  void forget() { predicted_.resize(0); }

 private:
  Eigen::VectorXd predicted_;  // z of the next image; empty: not known
};

}  // namespace ddm
