// PILCO's observations of images, by an auto-encoder or by principal components, and its task then.
// SPDX-License-Identifier: BSD-3-Clause
#include "image_observations.h"

#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>
#include <ddm_pilco/gp_training.h>
#include <ddm_pilco/messages.h>

#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

pilco::Gaussian startDistribution(const Eigen::MatrixXd& X, const std::vector<Piece>& pieces,
                                  double distance) {
  const Eigen::Index dim = X.rows();
  Eigen::MatrixXd first(dim, static_cast<Eigen::Index>(pieces.size()));
  for (size_t i = 0; i < pieces.size(); ++i) {
    first.col(static_cast<Eigen::Index>(i)) = X.col(pieces[i].begin);
  }
  const Eigen::VectorXd mean = first.rowwise().mean();
  const Eigen::MatrixXd centred = first.colwise() - mean;
  const Eigen::MatrixXd scatter =
      centred * centred.transpose() +
      distance * distance / static_cast<double>(dim) * Eigen::MatrixXd::Identity(dim, dim);
  return {mean, scatter / static_cast<double>(pieces.size())};
}

}  // namespace

PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Piece>& pieces,
                    const Eigen::VectorXd& goal, const PilcoOptions& options) {
  const Eigen::VectorXd std = pilco::sampleStd(X);
  const double spread = std.norm();
  if (!(spread > 0.0)) throw std::runtime_error("all images are observed as the same state");
  const int dim = static_cast<int>(X.rows());
  const double width = options.cost_width * spread;
  const Eigen::MatrixXd weight = Eigen::MatrixXd::Identity(dim, dim) / (width * width);
  return {{},
          startDistribution(X, pieces, options.start_std * spread),
          pilco::StateCost(pilco::replaceAngles(dim, {}), pilco::SaturatingCost(goal, weight)),
          std};
}

FeatureObservation::FeatureObservation(const ModelConfig& model, const PilcoOptions& options)
    : ImageObservation(model, options) {
  pilco::require(config_.training.schedule == "v_r_only",
                 "training/schedule must be v_r_only where PILCO learns the dynamics, got ",
                 config_.training.schedule);
}

std::vector<std::string> FeatureObservation::names() const {
  return featureNames(config_.model.feature_dim);
}

Eigen::MatrixXd FeatureObservation::learn(const std::vector<std::string>& /*bags*/,
                                          const DataSet& data, const TrialId& id) {
  ModelInfo info;
  info.seed = id.seed;
  info.trial = id.trial;
  info.config = toText(config_);
  const TrainingResult result = train(data, config_.model, config_.training, info);
  if (!result.model) throw std::runtime_error("auto-encoder: " + result.message);
  model_ = *result.model;
  const Eigen::MatrixXd Z = encodeAll(*model_, data);
  task_ = imageTask(Z, data.pieces(), model_->goalFeature(), options_);
  return Z;
}

std::map<std::string, std::string> FeatureObservation::files() const {
  return {{"model.ddm", serialiseModel(*model_)}};
}

std::vector<std::string> PcaObservation::names() const {
  return featureNames(config_.model.pca_dim);
}

Eigen::MatrixXd PcaObservation::learn(const std::vector<std::string>& /*bags*/, const DataSet& data,
                                      const TrialId& /*id*/) {
  pca_ = fitPca(data, config_.model.pca_dim, config_.training.score_std,
                Blur(data.imageSize(), config_.model.blur));
  const Eigen::MatrixXd Z = pca_.project(data).leftCols(data.numFrames()).cast<double>();
  if (!data.hasGoal())
    throw std::runtime_error(
        "the bags hold no goal image, which tells the goal: record one on goal_image");
  task_ = imageTask(Z, data.pieces(), observe(data.goal()), options_);
  return Z;
}

}  // namespace ddm
