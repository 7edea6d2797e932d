// Support states: a few of the states that were seen, spread evenly over where they are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/data_set.h"

namespace ddm {

/// Farthest-point sampling (Gonzalez, Theoretical Computer Science 1985): each point after the first is
/// the one that is farthest from all that are chosen before it.
/// @param points     one per column, at least one  [dim x N]
/// @param max_count  of points; there are fewer where fewer are different
/// @return           numbers of the columns, 0 first
std::vector<Eigen::Index> farthestPoints(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                         Eigen::Index max_count);

/// States x_t (eq. 8, see History) of frames, chosen by farthest points (z_t, z_t - z_{t-1}), both in units
/// of their spread.
/// @param Z          features of all frames, others may follow           [feature_dim x >= N]
/// @param data       torques and segments of the frames
/// @param memory     n + d, the frames of a state
/// @param max_count  of support states
/// @return           z_t ... z_{t-n-d+1}, then u_{t-1} ... u_{t-n-d+1} [N m], in each column
Eigen::MatrixXf supportStates(const Eigen::Ref<const Eigen::MatrixXf>& Z, const DataSet& data,
                              int memory, Eigen::Index max_count);

}  // namespace ddm
