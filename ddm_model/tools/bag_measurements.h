// What a model makes of bags: the files that `inspect` draws from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_options.h>
#include <ddm_model/ddm.h>

#include <string>
#include <vector>

namespace ddm {

/// Reads the bags, measures the model on all of them together and writes
///
///   bags.csv                a row a bag: camera, frames, pieces, what had no partner, interval
///   features.csv            a row a frame: torque, feature, errors of its image
///   spectrum.csv            a row a principal component
///   prediction_errors.csv   a row a number of steps ahead, none if no piece is long enough
///   predicted_features.csv  a typical and the worst prediction, step by step
///   images.yaml             how much the images differ
///   arrays/*.npy            images to show: reconstructions, predictions
///
/// into an existing folder. Progress goes to the standard error.
/// @param max_steps  longest prediction, shorter where all pieces are
/// @return           features of all frames  [feature_dim x N]
/// @throws std::runtime_error as readBag() does, or if a bag has another number of torques than the
///         model
Eigen::MatrixXd measureBags(const Ddm& model, const std::vector<std::string>& bags,
                            const BagOptions& topics, int max_steps, const std::string& folder);

}  // namespace ddm
