// Long-term predictions, and how wrong they are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"

namespace ddm {

/// Features of all images of a data set, one by one through the encoder.
/// @return Z  [feature_dim x numFrames()]
/// @throws std::invalid_argument if the images have another size than the model's
Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data);

/// Error of all predictions that many steps ahead.
struct PredictionError {
  int steps = 0;
  Eigen::Index num_predictions = 0;
  double rmse = 0.0;         ///< root mean square over all pixels of all predicted images [grey]
  double rmse_repeat = 0.0;  ///< the same for an image predicted to stay as it is [grey]
};

/// Predicts from all frames that have n + d - 1 predecessors and max_steps successors without a gap,
/// and compares with what came.
/// @param data       not learned from
/// @param max_steps  longest prediction
/// @return           for 1 ... max_steps steps ahead
/// @throws std::invalid_argument if the data do not fit the model, or have no such frame
std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data, int max_steps);

}  // namespace ddm
