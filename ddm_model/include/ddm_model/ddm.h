// A trained deep dynamical model: encoder, decoder and prediction model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/history.h"
#include "ddm_model/model_options.h"
#include "ddm_model/networks.h"
#include "ddm_model/pca.h"

namespace ddm {

/// Origin and statistics of a model, stored with the model.
struct ModelInfo {
  std::uint64_t seed = 0;    ///< seed of the experiment
  std::uint32_t trial = 0;   ///< last trial in the training data
  std::uint32_t frames = 0;  ///< number of samples in the training data
  double v_r = 0.0;          ///< V_R of the training data [grey^2]
  double v_p = 0.0;          ///< V_P of the training data [grey^2]
  /// Root mean squared distance of the training data's features to their mean; 0 if unknown.
  double feature_spread = 0.0;
  /// Support states, see supportStates(). Empty if unknown.  [state_dim x M]
  Eigen::MatrixXf support_states;
  std::string config;  ///< YAML text of the training configuration
};

/// Trained model (paper, eq. 3). Computes in double precision, one image or feature at a time.
class Ddm {
 public:
  /// @param image_size  width and height of the images [pixels]
  /// @param torque_dim  number of motors
  /// @param theta       theta_E, theta_D, theta_P                                  [P]
  /// @param goal        goal image, empty if there is none                         [D]
  /// @throws std::invalid_argument if sizes do not fit together or a number is not finite
  Ddm(ModelOptions options, int image_size, int torque_dim, Pca pca, Eigen::VectorXd theta,
      Image goal, ModelInfo info);

  /// Encodes an image: z = g^-1(y) (paper, eq. 3a).
  /// @param image  image  [D]
  /// @return      z      [feature_dim]
  /// @throws std::invalid_argument for a wrong number of pixels
  Eigen::VectorXd encode(const Image& image) const;

  /// Decodes a feature: y_hat = g(z) (paper, eq. 3b), clamped to the grey values 0 ... 255.
  /// @param z  [feature_dim]
  /// @return   image  [D]
  /// @pre z has feature_dim entries (checked by eigen_assert, i.e. in debug builds only)
  Image decode(const Eigen::VectorXd& z) const;

  /// z_ref, the feature of the goal image.
  /// @throws std::logic_error if the model has no goal image
  const Eigen::VectorXd& goalFeature() const;
  bool hasGoal() const { return !goal_.empty(); }

  /// Predicts one step from the controller state: z_{t+1} = f(h_n) (paper, eq. 2).
  /// @param x  controller state x_t (paper, eq. 8), not empty
  /// @param u  u_t [N m]                                                 [torque_dim]
  /// @return   z_{t+1}                                                   [feature_dim]
  /// @pre as above (checked by eigen_assert, i.e. in debug builds only)
  Eigen::VectorXd predict(const History& x, const Eigen::VectorXd& u) const;

  /// Predicts a rollout z_t, z_{t+1}, ..., z_{t+num_steps} (paper, eq. 2 step by step, and Sec.
  /// 4.1) from the features and torques of the samples t - n + 1 ... t and the torques after t.
  /// @param Z        features of all samples                              [feature_dim x N]
  /// @param torques  torques of all samples [N m]                          [torque_dim x N]
  /// @param frame    t, with n - 1 <= t <= N - num_steps. The samples used must have no gap
  /// @return         z_t, then the predicted features       [feature_dim x (num_steps + 1)]
  /// @pre as above (checked by eigen_assert, i.e. in debug builds only)
  Eigen::MatrixXd rollOut(const Eigen::MatrixXd& Z,
                          const Eigen::Ref<const Eigen::MatrixXd>& torques, Eigen::Index frame,
                          int num_steps) const;

  const PredictionModel<double>& predictionModel() const { return networks_.prediction_model; }
  /// @return theta_P, the parameters of predictionModel()  [P_f]
  const double* thetaP() const { return networks_.predictorOf(theta_.data()); }

  const ModelOptions& options() const { return options_; }
  const ModelInfo& info() const { return info_; }
  const Pca& pca() const { return pca_; }
  const Eigen::VectorXd& theta() const { return theta_; }
  const Image& goal() const { return goal_; }
  int imageSize() const { return image_size_; }
  int torqueDim() const { return networks_.prediction_model.torqueDim(); }
  int featureDim() const { return options_.feature_dim; }

 private:
  ModelOptions options_;
  int image_size_;
  Networks<double> networks_;
  Pca pca_;
  Projection projection_;
  Eigen::VectorXd theta_;
  Image goal_;
  ModelInfo info_;
  Eigen::VectorXd goal_feature_;
};

/// Encodes all images of a data set except the goal image.
/// @return Z  [feature_dim x numFrames()]
/// @throws std::invalid_argument if the size of the images is not that of the model
Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data);

}  // namespace ddm
