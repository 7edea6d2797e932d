// A trained deep dynamical model: encoder, decoder and prediction model.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/ddm.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ddm_model/roll_out.h"

namespace ddm {
namespace {

constexpr char kRemedy[] = "; train it again";

void requireSize(const std::string& number, Eigen::Index size, Eigen::Index due) {
  if (size == due) return;
  throw std::invalid_argument(
      textOf("model: the number of ", number, " must be ", due, ", got ", size, kRemedy));
}

template <class Values>
void requireFinite(const std::string& name, const Values& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (std::isfinite(values.data()[i])) continue;
    throw std::invalid_argument(
        textOf("model: ", name, " must be finite, number ", i, " is ", values.data()[i], kRemedy));
  }
}

/// @return number of centres of the Gaussian process in f with so many parameters of the model; 0:
///         f contains a network
Eigen::Index numCentres(const ModelOptions& options, int torque_dim, Eigen::Index num_params) {
  if (options.predictor != "gp") return 0;
  const Networks<double> one(options, torque_dim, /*num_centres=*/1), two(options, torque_dim, 2);
  return 1 + std::max<Eigen::Index>(num_params - one.numParams(), 0) /
                 (two.numParams() - one.numParams());
}

}  // namespace

Ddm::Ddm(ModelOptions options, int image_size, int torque_dim, Pca pca, Eigen::VectorXd theta,
         Image goal, ModelInfo info)
    : options_(std::move(options)),
      image_size_(image_size),
      networks_(options_, torque_dim, numCentres(options_, torque_dim, theta.size())),
      pca_(std::move(pca)),
      theta_(std::move(theta)),
      goal_(std::move(goal)),
      info_(std::move(info)) {
  const Eigen::Index num_pixels = static_cast<Eigen::Index>(image_size_) * image_size_;
  requireSize("pixels of the mean image", pca_.mean.size(), num_pixels);
  requireSize("rows of the PCA basis", pca_.basis.rows(), num_pixels);
  requireSize("columns of the PCA basis", pca_.basis.cols(), options_.pca_dim);
  requireSize("parameters", theta_.size(), networks_.numParams());
  if (hasGoal()) {
    requireSize("pixels of the goal image", static_cast<Eigen::Index>(goal_.size()), num_pixels);
  }
  requireFinite("parameters", theta_);
  requireFinite("PCA basis", pca_.basis);
  requireFinite("mean image", pca_.mean);
  requireFinite("PCA variances", pca_.variance);
  if (!isNotNegative(pca_.brightness)) {
    throw std::invalid_argument(textOf(
        "model: the brightness of images must be >= 0 and finite, got ", pca_.brightness, kRemedy));
  }
  if (!isPositive(pca_.scale)) {
    throw std::invalid_argument(
        textOf("model: the scale of PCA must be > 0 and finite, got ", pca_.scale, kRemedy));
  }
  projection_ = Projection(pca_);
  networks_.prediction_model.fixParameters(thetaP());
  if (hasGoal()) goal_feature_ = encode(goal_);
  // Finite parameters may still be too large to compute with.
  requireFinite("feature of the goal image", goal_feature_);
}

Eigen::VectorXd Ddm::encode(const Image& image) const {
  if (static_cast<Eigen::Index>(image.size()) != pca_.mean.size()) {
    throw std::invalid_argument(
        textOf("model: an image must have ", pca_.mean.size(), " pixels, got ", image.size()));
  }
  Mlp<double>::Tape tape;  // eq. (3a)
  networks_.encoder().forward(networks_.encoderOf(theta_.data()), projection_(image), &tape);
  return tape.output();
}

Image Ddm::decode(const Eigen::VectorXd& z) const {
  Mlp<double>::Tape tape;  // eq. (3b)
  networks_.decoder().forward(networks_.decoderOf(theta_.data()), z, &tape);
  const Eigen::MatrixXd scores = tape.output();
  const Eigen::MatrixXf image = pca_.reconstruct(scores.cast<float>());
  Image grey(image.size());
  for (Eigen::Index i = 0; i < image.size(); ++i) {
    grey[i] = static_cast<std::uint8_t>(
        std::lround(255.0F * std::min(1.0F, std::max(0.0F, image(i, 0)))));
  }
  return grey;
}

Eigen::VectorXd Ddm::predict(const History& x, const Eigen::VectorXd& u) const {
  eigen_assert(!x.empty() && u.size() == x.torques().rows());
  const Eigen::Index n = x.features().cols();
  Eigen::MatrixXd torques(u.size(), n);
  torques.leftCols(n - 1) = x.torques().rowwise().reverse();
  torques.col(n - 1) = u;
  return rollOut(x.features().rowwise().reverse(), torques, n - 1, 1).col(1);
}

Eigen::MatrixXd Ddm::rollOut(const Eigen::MatrixXd& Z,
                             const Eigen::Ref<const Eigen::MatrixXd>& torques, Eigen::Index frame,
                             int num_steps) const {
  const PredictionModel<double>& f = predictionModel();
  eigen_assert(Z.rows() == f.featureDim() && torques.rows() == f.torqueDim() &&
               torques.cols() == Z.cols());
  eigen_assert(num_steps >= 0 && frame >= f.order() - 1 && frame < Z.cols() &&
               frame + num_steps <= Z.cols());
  const Eigen::Index target = frame + 1;
  RollOut<double> predictions(f);
  predictions.forward(thetaP(), Z, torques, RollOut<double>::Targets(&target, 1), num_steps);
  Eigen::MatrixXd path(f.featureDim(), num_steps + 1);
  path.col(0) = Z.col(frame);
  for (int step = 0; step < num_steps; ++step) path.col(step + 1) = predictions.predicted(step);
  return path;
}

const Eigen::VectorXd& Ddm::goalFeature() const {
  if (!hasGoal()) throw std::logic_error("model has no goal image: train it with one");
  return goal_feature_;
}

Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data) {
  Eigen::MatrixXd Z(model.featureDim(), data.numFrames());
  for (Eigen::Index i = 0; i < data.numFrames(); ++i) {
    Z.col(i) = model.encode(data.image(i));
  }
  return Z;
}

}  // namespace ddm
