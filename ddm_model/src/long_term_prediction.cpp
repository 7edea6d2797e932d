// Long-term predictions, and how wrong they are.
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

/// Frames that have n + d - 1 predecessors and num_steps successors without a gap: what can be
/// predicted from. In the order of the data.
std::vector<Eigen::Index> predictionStarts(const Ddm& model, const DataSet& data, int num_steps) {
  std::vector<Eigen::Index> starts;
  for (const Segment& segment : data.segments()) {
    for (Eigen::Index i = model.options().memory() - 1; i + num_steps < segment.size; ++i) {
      starts.push_back(segment.begin + i);
    }
  }
  return starts;
}

}  // namespace

Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data) {
  Eigen::MatrixXd Z(model.featureDim(), data.numFrames());
  for (Eigen::Index i = 0; i < data.numFrames(); ++i) {
    Z.col(i) = model.encode(data.image(i));
  }
  return Z;
}

std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data,
                                              int max_steps) {
  if (max_steps < 1) throw std::invalid_argument("predictions: steps must be >= 1");
  const std::vector<Eigen::Index> starts = predictionStarts(model, data, max_steps);
  if (starts.empty()) {
    throw std::invalid_argument(
        "predictions: no frame has " + std::to_string(model.options().memory() - 1) +
        " frames before it and " + std::to_string(max_steps) + " after it without a gap");
  }
  const Eigen::MatrixXd Z = encodeAll(model, data);
  std::vector<PredictionError> errors(max_steps);
  for (const Eigen::Index frame : starts) {
    const Eigen::MatrixXd predicted = model.rollOut(Z, data.torques(), frame, max_steps);
    for (int k = 1; k <= max_steps; ++k) {
      const Grey& truth = data.image(frame + k);
      PredictionError& error = errors[k - 1];
      error.rmse += squaredDistance(model.decode(predicted.col(k)), truth);
      error.rmse_repeat += squaredDistance(data.image(frame), truth);
    }
  }
  const auto num_predictions = static_cast<Eigen::Index>(starts.size());
  const auto num_pixels = static_cast<double>(num_predictions * data.numPixels());
  for (int k = 1; k <= max_steps; ++k) {
    PredictionError& error = errors[k - 1];
    error.steps = k;
    error.num_predictions = num_predictions;
    for (double* sum : {&error.rmse, &error.rmse_repeat}) {
      *sum = std::sqrt(*sum / num_pixels);
    }
  }
  return errors;
}

}  // namespace ddm
