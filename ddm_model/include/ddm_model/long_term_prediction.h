// Long-term predictions: one-step predictions of f put one after the other, and how wrong they are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"
#include "ddm_model/history.h"

namespace ddm {

/// Features of all images of a data set, one by one through the encoder.
/// @return Z  [feature_dim x numFrames()]
/// @throws std::invalid_argument if the images have another size than the model's
Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data);

/// z_t, then z_{t+1} ... z_{t+num_steps} predicted from the last n features and torques that were
/// seen until t, and the torques that followed (paper, Sec. 4.1):
///
///   z_{k+1} = f(z_k, u_k, ..., z_{k-n+1}, u_{k-n+1}),   every z after t predicted
///
/// @param Z        features of all frames                               [feature_dim x N]
/// @param torques  torques of all frames [N m]                           [torque_dim x N]
/// @param frame    t; n - 1 <= t <= N - num_steps. No gap may lie in between
/// @return         [feature_dim x (num_steps + 1)]
/// @throws std::invalid_argument for sizes or a frame that do not fit
Eigen::MatrixXd rollOut(const Ddm& model, const Eigen::MatrixXd& Z,
                        const Eigen::Ref<const Eigen::MatrixXd>& torques, Eigen::Index frame,
                        int num_steps);

/// z_{t+1} = f(h), one step from the state that a policy keeps.
/// @param x  features and torques until t, not empty
/// @param u  u_t [N m]                                                 [torque_dim]
/// @return   [feature_dim]
/// @throws std::invalid_argument if x is empty
Eigen::VectorXd predictNext(const Ddm& model, const History& x, const Eigen::VectorXd& u);

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
