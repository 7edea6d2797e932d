// What PILCO takes for the state: the true state, features of images, or principal components of images.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/random_stream.h>
#include <ddm_model/data_set.h>
#include <ddm_sim/plant.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "pilco/state_cost.h"

namespace ddm {

/// What is to be learned, in the coordinates of an observation.
struct PilcoTask {
  std::vector<int> angles;  ///< entries of x that are angles [rad]
  bool noisy;               ///< whether x, as the policy sees it, is measured with noise
  pilco::Gaussian start;    ///< p(x_0)
  pilco::StateCost cost;    ///< c
  Eigen::VectorXd policy_length_scales;  ///< of the first policy, one for each of its inputs
};

/// All samples that were recorded, as an observation sees them.
struct ObservedData {
  Eigen::MatrixXd X;  ///< x of each sample  [names().size() x N]
  PilcoTask task;
};

/// Turns what happens into the state x that PILCO learns from and acts on.
class Observation {
 public:
  virtual ~Observation() = default;

  /// Names of the entries of x with their units, as the headers of CSV files have them.
  virtual std::vector<std::string> names() const = 0;

  /// Learns to observe, where there is something to learn, and observes all that is recorded.
  /// @param bags  of all trials, the random one first
  /// @param data  their content
  /// @throws std::runtime_error naming what is missing or failed
  virtual ObservedData learn(const std::vector<std::string>& bags, const DataSet& data,
                             const TrialId& id) = 0;

  /// Observes as after learn() with the same arguments, by the files() that it left in a folder.
  /// @throws std::runtime_error as learn(), or if a file is damaged
  virtual ObservedData resume(const std::string& /*folder*/, const std::vector<std::string>& bags,
                              const DataSet& data, const TrialId& id) {
    return learn(bags, data, id);
  }

  /// Whether x has the same coordinates after each learn(), so that an old policy keeps its meaning.
  virtual bool keepsCoordinates() const { return false; }

  /// Files that the training is to leave in its folder: content by name.
  virtual std::map<std::string, std::string> files() const { return {}; }

  virtual void startTrial(const TrialId& /*id*/) {}

  /// Called once for each sample of a trial, in turn.
  /// @param grey  the image just seen
  /// @return      x
  virtual Eigen::VectorXd observe(const Grey& grey) = 0;
};

/// x = (rate, angle) + noise of a pendulum, the angle not wrapped. Only here does the true state reach
/// a policy: bags do not contain it, so learn() reads it from trajectory.csv next to each bag.
///
/// The noise of a trial has a random stream of its own, so that learn() computes the same measurements
/// on which the policy acted in that trial.
/// @param plant  the one that is controlled, outlives the observation
/// @throws std::invalid_argument if the plant is not one joint with angle and rate, or if its goal is
///         not upright, at pi
std::unique_ptr<Observation> observeTrueState(const Plant& plant);

/// x = z = g^-1(y), features of one image. The auto-encoder minimises V_R alone, and learns anew from
/// all data after each trial.
/// @throws std::invalid_argument if training/schedule trains more than the auto-encoder
std::unique_ptr<Observation> observeFeatures(const ModelConfig& model);

/// x = PCA scores of one image, model/pca_dim of them (paper, Sec. 4.2: 20), anew after each trial.
std::unique_ptr<Observation> observePrincipalComponents(const ModelConfig& model);

/// The task of an observation of images. The spread is the root of the mean squared distance to the
/// mean of all samples (the length of a pendulum, if x were the tip of one that turns all the way
/// round).
///
///   c(x) = 1 - exp(-|x - goal|^2 / (2 (0.5 spread)^2))
///   p(x_0): mean and scatter of the first samples of all trials, counted together with one more
///           sample at the distance 0.1 spread
///
/// @param X     x of all samples                                                        [D x N]
/// @param goal  x of the goal image                                                         [D]
/// @throws std::runtime_error if all samples are the same
PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Segment>& segments,
                    const Eigen::VectorXd& goal);

}  // namespace ddm
