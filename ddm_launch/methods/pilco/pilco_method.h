// PILCO as a method, and its observations: true state, features of images, principal components.
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
#include "method.h"
#include "pilco/options.h"
#include "pilco/state_cost.h"

namespace ddm {

/// The control task in the coordinates x of an observation.
struct PilcoTask {
  std::vector<int> angles;               ///< entries of x that are angles [rad]
  bool noisy;                            ///< whether the policy sees x with measurement noise
  pilco::Gaussian start;                 ///< p(x_0)
  pilco::StateCost cost;                 ///< c
  Eigen::VectorXd policy_length_scales;  ///< of the first policy, one for each of its inputs
};

/// All recorded samples in the coordinates of an observation.
struct ObservedData {
  Eigen::MatrixXd X;  ///< x of each sample, one per column  [names().size() x N]
  PilcoTask task;
};

/// Maps images or true states to the state x that PILCO learns from and acts on.
class Observation {
 public:
  virtual ~Observation() = default;

  /// Names of the entries of x with their units, for headers of CSV files.
  virtual std::vector<std::string> names() const = 0;

  /// Trains the observation, if it has parameters, and computes x for all recorded samples.
  /// @param bags  paths of the bags of all trials, the random trial first
  /// @param data  content of the bags
  /// @throws std::runtime_error naming what is missing or has failed
  virtual ObservedData learn(const std::vector<std::string>& bags, const DataSet& data,
                             const TrialId& id) = 0;

  /// Restores the result of learn() with the same arguments from the files() in a folder.
  /// @throws std::runtime_error as learn(), or if a file is damaged
  virtual ObservedData resume(const std::string& /*folder*/, const std::vector<std::string>& bags,
                              const DataSet& data, const TrialId& id) {
    return learn(bags, data, id);
  }

  /// Whether x has the same coordinates after each learn(), so that an old policy can still be
  /// used.
  virtual bool keepsCoordinates() const { return false; }

  /// Files that the training must keep in its folder: content by name.
  virtual std::map<std::string, std::string> files() const { return {}; }

  virtual void startTrial(const TrialId& /*id*/) {}

  /// Computes the state from the current image. Must be called for each sample of a trial in turn.
  /// @param image  latest image
  /// @return      x
  virtual Eigen::VectorXd observe(const Image& image) = 0;
};

/// x = (rate, angle) + noise of a pendulum; the angle is not wrapped. Only this observation gives a
/// policy access to the true state. Bags do not contain the true state: learn() reads it from
/// trajectory.csv next to each bag.
///
/// The noise of each trial has its own random stream, so that learn() computes the same
/// measurements that the policy acted on in that trial.
/// @param plant  the controlled plant; must outlive the observation
/// @throws std::invalid_argument if the plant is not one joint with angle and rate, or if its goal
///         is not the upright position pi
std::unique_ptr<Observation> observeTrueState(const Configuration& all, const Plant& plant);

/// x = z = g^-1(y), the features of one image. The auto-encoder minimises V_R alone and is trained
/// anew on all data after each trial.
/// @throws std::invalid_argument if training/schedule trains more than the auto-encoder
std::unique_ptr<Observation> observeFeatures(const Configuration& all, const Plant& plant);

/// x = the first model/pca_dim PCA scores of one image (paper, Sec. 4.2: 20 scores). The PCA is
/// computed anew after each trial.
std::unique_ptr<Observation> observePrincipalComponents(const Configuration& all,
                                                        const Plant& plant);

/// The task of an observation of images. The spread is the root mean square distance of all samples
/// to their mean. (If x were the position of the tip of a pendulum that turns all the way round,
/// the spread would be the length of the pendulum.)
///
///   c(x) = 1 - exp(-|x - goal|^2 / (2 (0.5 spread)^2))
///   p(x_0): mean and covariance of the first samples of all trials and of one additional sample at
///           the distance 0.1 spread
///
/// @param X     x of all samples                                                        [D x N]
/// @param goal  x of the goal image                                                         [D]
/// @throws std::runtime_error if all samples are equal
PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Segment>& segments,
                    const Eigen::VectorXd& goal);

/// PILCO as a method. After each trial, it trains GPs of the dynamics on all data, then searches the
/// policy that minimises the expected cost over the horizon (Deisenroth and Rasmussen, 2011, Alg.
/// 1). Training k begins with the policy and the hyper-parameters that training k - 1 left in its
/// folder. If the coordinates of the observation have changed, both begin from initial values.
///
/// A training leaves pilco.yaml (statistics, and what the next training needs) and prediction.csv
/// (predicted distributions of states and costs). train() throws std::runtime_error if a file cannot
/// be read or the GPs cannot be trained. resume() reads the policy from pilco.yaml; acting needs no
/// GPs, so that no training is repeated. It throws std::runtime_error if a file is damaged.
/// @param configuration  must outlive the method
std::unique_ptr<Method> makePilcoMethod(const Configuration& configuration,
                                        const pilco::PilcoOptions& options,
                                        std::unique_ptr<Observation> observation);

}  // namespace ddm
