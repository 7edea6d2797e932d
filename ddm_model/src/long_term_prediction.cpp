// Long-term predictions: one-step predictions of f put one after the other, and how wrong they are.
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

Eigen::MatrixXd rollOut(const Ddm& model, const Eigen::MatrixXd& Z,
                        const Eigen::Ref<const Eigen::MatrixXd>& torques, Eigen::Index frame,
                        int num_steps) {
  const PredictionModel<double>& f = model.predictionModel();
  const Eigen::Index n = f.order();
  if (Z.rows() != f.featureDim() || torques.rows() != f.torqueDim() || torques.cols() != Z.cols()) {
    throw std::invalid_argument("roll-out: features or torques do not fit the model");
  }
  if (num_steps < 0 || frame < n - 1 || frame >= Z.cols() || frame + num_steps > Z.cols()) {
    throw std::invalid_argument("roll-out: frame " + std::to_string(frame) + " needs " +
                                std::to_string(n - 1) + " frames before it and torques for " +
                                std::to_string(num_steps) + " steps, there are " +
                                std::to_string(Z.cols()) + " frames");
  }
  Eigen::MatrixXd path(f.featureDim(), n + num_steps);  // z_{t-n+1} ... z_{t+num_steps}
  path.leftCols(n) = Z.middleCols(frame - n + 1, n);
  Eigen::VectorXd h(f.regressorDim());
  Mlp<double>::Tape tape;
  for (int step = 0; step < num_steps; ++step) {
    for (int lag = 0; lag < n; ++lag) {
      h.segment(f.featureRow(lag), f.featureDim()) = path.col(n - 1 + step - lag);
      h.segment(f.torqueRow(lag), f.torqueDim()) =
          torques.col(frame + step - lag) / model.options().max_torque;
    }
    f.forward(model.thetaP(), h, &tape, path.col(n + step));
  }
  return path.rightCols(num_steps + 1);
}

Eigen::VectorXd predictNext(const Ddm& model, const History& x, const Eigen::VectorXd& u) {
  const PredictionModel<double>& f = model.predictionModel();
  if (x.empty()) throw std::invalid_argument("prediction: there is no feature to predict from");
  Eigen::VectorXd h(f.regressorDim());
  for (int lag = 0; lag < f.order(); ++lag) {
    h.segment(f.featureRow(lag), f.featureDim()) = x.features().col(lag);
    auto torque = h.segment(f.torqueRow(lag), f.torqueDim());
    if (lag == 0) {
      torque = u / model.options().max_torque;
    } else {
      torque = x.torques().col(lag - 1) / model.options().max_torque;
    }
  }
  Mlp<double>::Tape tape;
  Eigen::MatrixXd z(f.featureDim(), 1);
  f.forward(model.thetaP(), h, &tape, z);
  return z.col(0);
}

std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data,
                                              int max_steps) {
  if (max_steps < 1) throw std::invalid_argument("predictions: steps must be >= 1");
  const Eigen::MatrixXd Z = encodeAll(model, data);
  const Eigen::Index n = model.predictionModel().order();
  std::vector<PredictionError> errors(max_steps);
  for (const Piece& piece : data.pieces()) {
    for (Eigen::Index i = n - 1; i + max_steps < piece.size; ++i) {
      const Eigen::Index frame = piece.begin + i;
      const Eigen::MatrixXd predicted = rollOut(model, Z, data.torques(), frame, max_steps);
      for (int k = 1; k <= max_steps; ++k) {
        const Grey y_hat = model.decode(predicted.col(k));
        PredictionError& error = errors[k - 1];
        ++error.num_predictions;
        error.rmse += squaredDistance(y_hat, data.image(frame + k));
        error.rmse_repeat += squaredDistance(data.image(frame), data.image(frame + k));
      }
    }
  }
  for (int k = 1; k <= max_steps; ++k) {
    PredictionError& error = errors[k - 1];
    if (error.num_predictions == 0) {
      throw std::invalid_argument("predictions: no frame has " + std::to_string(n - 1) +
                                  " frames before it and " + std::to_string(max_steps) +
                                  " after it without a gap");
    }
    const double num_pixels = static_cast<double>(error.num_predictions * data.numPixels());
    error.steps = k;
    error.rmse = std::sqrt(error.rmse / num_pixels);
    error.rmse_repeat = std::sqrt(error.rmse_repeat / num_pixels);
  }
  return errors;
}

}  // namespace ddm
