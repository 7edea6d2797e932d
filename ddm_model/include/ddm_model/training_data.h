// What the objective is computed from: PCA scores and torques of a data set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/pca.h"

namespace ddm {

template <class Scalar>
struct TrainingData {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix scores;                  ///< all frames, then the goal if there is one  [pca_dim x M]
  Eigen::MatrixXd torques;        ///< [N m]                               [torque_dim x N]
  std::vector<Segment> segments;  ///< no prediction straddles two of them
};

inline TrainingData<float> makeTrainingData(const DataSet& data, const Pca& pca) {
  return {pca.project(data), data.torques(), data.segments()};
}

/// Stretches of up to 100 frames, spread evenly over all and at most so many frames together, and the goal.
/// @param max_frames  more than there are: all; fewer than 100: the stretches are shorter
/// @param longer_than  shorter stretches are left out [frames]
/// @return             all of the data, if no stretch is long enough
TrainingData<float> evenPart(const TrainingData<float>& data, Eigen::Index max_frames,
                             Eigen::Index longer_than);

}  // namespace ddm
