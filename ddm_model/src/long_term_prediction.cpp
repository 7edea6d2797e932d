// Long-term predictions: from which frames they can be made, and how wrong they are.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/long_term_prediction.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

using Pixels = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>;

/// Sum over all pixels of the squared difference [grey^2].
double squaredDistance(const Grey& a, const Grey& b) {
  const auto size = static_cast<Eigen::Index>(a.size());
  return (Eigen::Map<const Pixels>(a.data(), size).cast<double>() -
          Eigen::Map<const Pixels>(b.data(), size).cast<double>())
             .squaredNorm() /
         (255.0 * 255.0);
}

}  // namespace

Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data) {
  Eigen::MatrixXd Z(model.featureDim(), data.numFrames());
  for (Eigen::Index i = 0; i < data.numFrames(); ++i) {
    Z.col(i) = model.encode(data.image(i));
  }
  return Z;
}

std::vector<Eigen::Index> predictionStarts(const Ddm& model, const DataSet& data, int num_steps) {
  std::vector<Eigen::Index> starts;
  for (const Piece& piece : data.pieces()) {
    for (Eigen::Index i = model.options().memory() - 1; i + num_steps < piece.size; ++i) {
      starts.push_back(piece.begin + i);
    }
  }
  return starts;
}

std::vector<Eigen::Index> thinnedOut(const std::vector<Eigen::Index>& frames, Eigen::Index number) {
  const auto size = static_cast<Eigen::Index>(frames.size());
  if (size <= number) return frames;
  std::vector<Eigen::Index> out;
  for (Eigen::Index i = 0; i < number; ++i) out.push_back(frames[i * size / number]);
  return out;
}

std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data,
                                              const std::vector<Eigen::Index>& starts,
                                              int max_steps,
                                              const std::function<void(double)>& progress) {
  if (max_steps < 1) throw std::invalid_argument("predictions: steps must be >= 1");
  if (starts.empty()) {
    throw std::invalid_argument(
        "predictions: no frame has " + std::to_string(model.options().memory() - 1) +
        " frames before it and " + std::to_string(max_steps) + " after it without a gap");
  }
  const Eigen::MatrixXd Z = encodeAll(model, data);
  const Eigen::VectorXd mean_torque = data.torques().rowwise().mean();
  Eigen::MatrixXd told = data.torques();
  std::vector<PredictionError> errors(max_steps);
  for (size_t i = 0; i < starts.size(); ++i) {
    const Eigen::Index frame = starts[i];
    const Eigen::MatrixXd predicted = model.rollOut(Z, data.torques(), frame, max_steps);
    told.middleCols(frame, max_steps).colwise() = mean_torque;
    const Eigen::MatrixXd blind = model.rollOut(Z, told, frame, max_steps);
    told.middleCols(frame, max_steps) = data.torques().middleCols(frame, max_steps);
    for (int k = 1; k <= max_steps; ++k) {
      const Grey& truth = data.image(frame + k);
      PredictionError& error = errors[k - 1];
      error.rmse += squaredDistance(model.decode(predicted.col(k)), truth);
      error.rmse_repeat += squaredDistance(data.image(frame), truth);
      error.rmse_mean_torque += squaredDistance(model.decode(blind.col(k)), truth);
    }
    progress(static_cast<double>(i + 1) / static_cast<double>(starts.size()));
  }
  const auto num_predictions = static_cast<Eigen::Index>(starts.size());
  const auto num_pixels = static_cast<double>(num_predictions * data.numPixels());
  for (int k = 1; k <= max_steps; ++k) {
    PredictionError& error = errors[k - 1];
    error.steps = k;
    error.num_predictions = num_predictions;
    for (double* sum : {&error.rmse, &error.rmse_repeat, &error.rmse_mean_torque}) {
      *sum = std::sqrt(*sum / num_pixels);
    }
  }
  return errors;
}

std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data,
                                              int max_steps) {
  return predictionErrors(model, data, predictionStarts(model, data, max_steps), max_steps);
}

}  // namespace ddm
