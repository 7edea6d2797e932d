// A trained deep dynamical model: images to features, features to images, features ahead in time.
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

/// Where a model comes from; travels with it.
struct ModelInfo {
  std::uint64_t seed = 0;    ///< seed of the experiment
  std::uint32_t trial = 0;   ///< last trial learned from
  std::uint32_t frames = 0;  ///< frames learned from
  double v_r = 0.0;          ///< V_R [grey^2]
  double v_p = 0.0;          ///< V_P [grey^2]
  /// Root of the mean squared distance of the features learned from to their mean; 0: not known.
  double feature_spread = 0.0;
  /// States learned from, see supportStates(); empty: not known.  [state_dim x M]
  Eigen::MatrixXf support_states;
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

  /// z = g^-1(y) (eq. 3a)
  /// @param grey  image  [D]
  /// @return      z      [feature_dim]
  /// @throws std::invalid_argument for a wrong number of pixels
  Eigen::VectorXd encode(const Grey& grey) const;

  /// y_hat = g(z) (eq. 3b), clamped to what an image can show.
  /// @param z  [feature_dim]
  /// @pre the size of z (checked by eigen_assert, i.e. in debug builds only)
  Grey decode(const Eigen::VectorXd& z) const;

  /// z_ref, the feature of the goal image.
  /// @throws std::logic_error if the model has no goal image
  const Eigen::VectorXd& goalFeature() const;
  bool hasGoal() const { return !goal_.empty(); }

  /// z_{t+1} = f(h_n), one step from the state that a policy keeps (eq. 2).
  /// @param x  features and torques until t, not empty
  /// @param u  u_t [N m]                                                 [torque_dim]
  /// @return   [feature_dim]
  /// @throws std::invalid_argument if x is empty, or x or u do not fit the model
  Eigen::VectorXd predict(const History& x, const Eigen::VectorXd& u) const;

  /// z_t, then z_{t+1} ... z_{t+num_steps} predicted from the last n + d features and torques that
  /// were seen until t, and the torques that followed (paper, Sec. 4.1).
  /// @param Z        features of all frames                               [feature_dim x N]
  /// @param torques  torques of all frames [N m]                           [torque_dim x N]
  /// @param frame    t; n + d - 1 <= t <= N - num_steps. No gap may lie in between
  /// @return         [feature_dim x (num_steps + 1)]
  /// @throws std::invalid_argument for sizes or a frame that do not fit
  Eigen::MatrixXd rollOut(const Eigen::MatrixXd& Z,
                          const Eigen::Ref<const Eigen::MatrixXd>& torques, Eigen::Index frame,
                          int num_steps) const;

  const PredictionModel<double>& predictionModel() const { return networks_.prediction_model; }
  /// Parameters theta_P of predictionModel().
  const double* thetaP() const { return networks_.predictorOf(theta_.data()); }

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
  Projection projection_;
  Eigen::VectorXd theta_;
  Grey goal_;
  ModelInfo info_;
  Eigen::VectorXd goal_feature_;
};

/// Features of all images of a data set, one by one through the encoder.
/// @return Z  [feature_dim x numFrames()]
/// @throws std::invalid_argument if the images have another size than the model's
Eigen::MatrixXd encodeAll(const Ddm& model, const DataSet& data);

/// Error of all predictions that many steps ahead.
struct PredictionError {
  int steps = 0;
  Eigen::Index num_predictions = 0;
  double rmse = 0.0;         ///< root mean square over all pixels of all predicted images [grey]
  double rmse_repeat = 0.0;  ///< the same for an image predicted to stay as it is [grey]
};

/// Predicts from all frames that have n + d - 1 predecessors and max_steps successors without a gap,
/// and compares with what came.
/// @param data       not learned from
/// @param max_steps  longest prediction
/// @return           for 1 ... max_steps steps ahead
/// @throws std::invalid_argument if the data do not fit the model, or have no such frame
std::vector<PredictionError> predictionErrors(const Ddm& model, const DataSet& data, int max_steps);

}  // namespace ddm
