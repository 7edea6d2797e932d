// PILCO's observations of images, by an auto-encoder or by principal components, and its task then.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/pca.h>

#include <optional>

#include "configuration.h"
#include "observation.h"
#include "pilco_options.h"

namespace ddm {

/// Goal: that of the goal image. Spread: root of the mean squared distance to the mean of all
/// frames (the length of a pendulum, if x were the tip of one that turns all the way round).
///
///   c(x) = 1 - exp(-|x - goal|^2 / (2 (cost_width spread)^2))
///   p(x_0): mean and scatter of the first frames of all trials, counted together with one more
///           frame at the distance start_std * spread
///
/// @param X     x of all frames                                                         [D x N]
/// @param goal  x of the goal image                                                         [D]
/// @throws std::runtime_error if all frames are the same
PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Piece>& pieces,
                    const Eigen::VectorXd& goal, const PilcoOptions& options);

/// Learned anew from all data after each trial, so its coordinates change.
class ImageObservation : public Observation {
 public:
  ImageObservation(const ModelConfig& model, const PilcoOptions& options)
      : config_(model), options_(options) {}

  bool keepsCoordinates() const override { return false; }
  PilcoTask task() const override { return *task_; }
  void startTrial(const TrialId& /*id*/) override {}

 protected:
  ModelConfig config_;
  PilcoOptions options_;
  std::optional<PilcoTask> task_;  ///< learn() sets it
};

/// x = z = g^-1(y), 2-D features of one image. The auto-encoder minimises V_R alone
/// (training/schedule v_r_only).
class FeatureObservation : public ImageObservation {
 public:
  /// @throws std::invalid_argument if training/schedule trains more than the auto-encoder
  FeatureObservation(const ModelConfig& model, const PilcoOptions& options);

  std::vector<std::string> names() const override;
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  std::map<std::string, std::string> files() const override;
  Eigen::VectorXd observe(const Grey& grey) override { return model_->encode(grey); }

 private:
  std::optional<Ddm> model_;
};

/// x = PCA scores of one image, model/pca_dim of them (paper, Sec. 4.2: 20).
class PcaObservation : public ImageObservation {
 public:
  using ImageObservation::ImageObservation;

  std::vector<std::string> names() const override;
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  Eigen::VectorXd observe(const Grey& grey) override { return pca_.project(grey).cast<double>(); }

 private:
  Pca pca_;
};

}  // namespace ddm
