// PILCO's task in coordinates that come from images: goal, start and scale from the data.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <Eigen/Core>

#include "observation.h"
#include "pilco_options.h"

namespace ddm {

/// Goal: that of the goal image. Spread: root of the mean squared distance to the mean of all
/// frames (the length of a pendulum, if x were the tip of one that turns all the way round).
///
///   c(x) = 1 - exp(-|x - goal|^2 / (2 (cost_width spread)^2))
///   p(x_0): mean and scatter of the first frames of all trials, counted together with one more
///           frame at the distance start_std * spread
///
/// @param X     x of all frames                                                         [D x N]
/// @param goal  x of the goal image                                                         [D]
/// @throws std::runtime_error if all frames are the same
PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Piece>& pieces,
                    const Eigen::VectorXd& goal, const PilcoOptions& options);

}  // namespace ddm
