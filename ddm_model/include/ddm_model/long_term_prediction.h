// Long-term predictions: from which frames they can be made, and how wrong they are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"

namespace ddm {

/// Features of all images of a data set, one by one through the encoder.
/// @return Z  [feature_dim x numFrames()]
/// @throws std::invalid_argument if the images have another size than the model's
Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data);

/// Frames that have n - 1 predecessors and num_steps successors without a gap: what can be
/// predicted from. In the order of the data.
std::vector<Eigen::Index> predictionStarts(const Ddm& model, const DataSet& data, int num_steps);

/// So many of them, evenly spread over all; all of them if there are no more.
std::vector<Eigen::Index> thinnedOut(const std::vector<Eigen::Index>& frames, Eigen::Index number);

/// Error of all predictions that many steps ahead.
struct PredictionError {
  int steps = 0;
  Eigen::Index num_predictions = 0;
  double rmse = 0.0;         ///< root mean square over all pixels of all predicted images [grey]
  double rmse_repeat = 0.0;  ///< the same for an image predicted to stay as it is [grey]
  /// The same for predictions that are told of the mean torque instead of the torques that followed
  /// the frame: what these are worth [grey].
  double rmse_mean_torque = 0.0;
};

/// Predicts from each of these frames and compares with what came.
/// @param starts     as from predictionStarts(), at least one
/// @param max_steps  longest prediction
/// @param progress   told which fraction is done
/// @return           for 1 ... max_steps steps ahead
/// @throws std::invalid_argument if the data do not fit the model, or there is no frame to start
///         from
std::vector<PredictionError> predictionErrors(
    const Ddm& model, const DataSet& data, const std::vector<Eigen::Index>& starts, int max_steps,
    const std::function<void(double)>& progress = [](double) {});

/// Predicts from all frames of a data set that can be.
/// @param data  not learned from
/// @throws std::invalid_argument if the data do not fit the model, or have no such frame
std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data, int max_steps);

}  // namespace ddm
