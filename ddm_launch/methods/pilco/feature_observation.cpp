// PILCO's observation by an auto-encoder that is trained alone: 2-D features of one image.
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_observation.h"

#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>

#include <stdexcept>
#include <utility>

#include "csv_text.h"
#include "image_task.h"

namespace ddm {

FeatureObservation::FeatureObservation(ModelConfig model, const PilcoOptions& options)
    : config_(std::move(model)), options_(options) {
  if (config_.training.schedule != "v_r_only") {
    throw std::invalid_argument(
        "training/schedule must be v_r_only where PILCO learns the dynamics, got " +
        config_.training.schedule);
  }
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

}  // namespace ddm
