// A trained deep dynamical model: images to features, features to images, features ahead in time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/model_options.h"
#include "ddm_model/networks.h"
#include "ddm_model/pca.h"

namespace ddm {

/// Where a model comes from; travels with it.
struct ModelInfo {
  std::uint64_t seed = 0;    ///< seed of the experiment
  std::uint32_t trial = 0;   ///< last trial learned from
  std::uint32_t frames = 0;  ///< frames learned from
  double v_r = 0.0;          ///< V_R [grey^2]
  double v_p = 0.0;          ///< V_P [grey^2]
  /// Root of the mean squared distance of the features learned from to their mean; 0: not known.
  double feature_spread = 0.0;
  std::string config;  ///< YAML text of the configuration it was trained with
};

/// The trained model of eq. (3) of the paper. Computes in double, one image or feature at a time.
class Ddm {
 public:
  /// @param image_size  images have image_size x image_size pixels
  /// @param torque_dim  number of motors
  /// @param theta       theta_E, theta_D, theta_P
  /// @param goal        goal image, empty if there is none
  /// @throws std::invalid_argument if shapes do not fit together
  Ddm(ModelOptions options, int image_size, int torque_dim, Pca pca, Eigen::VectorXd theta,
      Grey goal, ModelInfo info);

  /// z = g^-1(y)
  /// @param grey  image  [D]
  /// @return      z      [feature_dim]
  /// @throws std::invalid_argument for a wrong number of pixels
  Eigen::VectorXd encode(const Grey& grey) const;

  /// y_hat = g(z), clamped to what an image can show.
  /// @param z  [feature_dim]
  Grey decode(const Eigen::VectorXd& z) const;

  /// z_ref, the feature of the goal image.
  /// @throws std::logic_error if the model has no goal image
  const Eigen::VectorXd& goalFeature() const;
  bool hasGoal() const { return !goal_.empty(); }

  const PredictionModel<double>& predictionModel() const { return networks_.prediction_model; }
  /// Parameters theta_P of predictionModel().
  const double* thetaP() const { return networks_.predictorOf(theta_.data()); }

  /// The rest of an ensemble, trained on the same data from other starts; empty for a single model.
  const std::vector<Ddm>& others() const { return others_; }
  /// @throws std::invalid_argument if one has another image size or number of motors, or others
  /// itself
  void setOthers(std::vector<Ddm> others);

  const ModelOptions& options() const { return options_; }
  const ModelInfo& info() const { return info_; }
  const Pca& pca() const { return pca_; }
  const Eigen::VectorXd& theta() const { return theta_; }
  const Grey& goal() const { return goal_; }
  int imageSize() const { return image_size_; }
  int torqueDim() const { return networks_.prediction_model.torqueDim(); }
  int featureDim() const { return options_.feature_dim; }

 private:
  ModelOptions options_;
  int image_size_;
  Networks<double> networks_;
  Pca pca_;
  Eigen::VectorXd theta_;
  Grey goal_;
  ModelInfo info_;
  Eigen::VectorXd goal_feature_;
  std::vector<Ddm> others_;
};

}  // namespace ddm
