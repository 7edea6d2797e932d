// What PILCO takes for the state, and its policy: the seam between its mathematics and true state or images.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>
#include <ddm_model/ddm.h>
#include <ddm_model/pca.h>
#include <ddm_mpc/policy.h>
#include <ddm_pilco/features.h>
#include <ddm_pilco/policy.h>
#include <ddm_sim/plant.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "configuration.h"
#include "driver.h"

namespace ddm {

/// What is to be learned, in the coordinates of an observation.
struct PilcoTask {
  std::vector<int> angles;               ///< entries that are angles [rad]
  bool noisy;                            ///< x is measured with noise, and the policy sees it so
  pilco::Gaussian start;                 ///< p(x_0)
  pilco::StateCost cost;                 ///< c
  Eigen::VectorXd policy_length_scales;  ///< of the first policy, one for each of its inputs
};

/// Turns what happens into the state x that PILCO learns from and acts on.
class Observation {
 public:
  virtual ~Observation() = default;

  /// Names of the entries of x with their units, as the headers of CSV files have them.
  virtual std::vector<std::string> names() const = 0;

  /// Learns to observe, where there is something to learn, and observes all that is recorded.
  /// @param bags  of all trials, the random one first
  /// @param data  what they hold
  /// @return      x of each frame of `data`                                 [names().size() x N]
  /// @throws std::runtime_error naming what is missing or failed
  virtual Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                                const TrialId& id) = 0;

  /// Observes as after learn() with the same arguments, by the files() that it left in a folder.
  /// @throws std::runtime_error as learn(), or if a file is damaged
  virtual void resume(const std::string& /*folder*/, const std::vector<std::string>& bags,
                      const DataSet& data, const TrialId& id) {
    learn(bags, data, id);
  }

  /// The coordinates of x are the same after each learn(): what was learned in them stays true.
  virtual bool keepsCoordinates() const = 0;

  /// After learn().
  virtual PilcoTask task() const = 0;

  /// What learn() leaves to be kept: content by name of a file.
  virtual std::map<std::string, std::string> files() const { return {}; }

  virtual void startTrial(const TrialId& id) = 0;

  /// Called once for each frame of a trial, in turn.
  /// @param grey  the image just seen
  /// @return      x
  virtual Eigen::VectorXd observe(const Grey& grey) = 0;
};

/// x = (rate, angle) + noise of a pendulum, the angle not wrapped. The only code where the true
/// state meets a policy.
///
/// The noise of a trial is a stream of its own, so that learning from a recorded trial meets the
/// very measurements that the policy acted on in it.
class TrueStateObservation : public Observation {
 public:
  /// @param plant  the one that is controlled, outlives the observation
  /// @throws std::invalid_argument if the plant is not one joint with angle and rate, or if its
  ///         goal is not upright, at pi
  explicit TrueStateObservation(const Plant& plant);

  std::vector<std::string> names() const override;
  /// Reads the true state from trajectory.csv next to each bag. Bags do not contain it.
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  bool keepsCoordinates() const override { return true; }
  PilcoTask task() const override;
  void startTrial(const TrialId& id) override;
  Eigen::VectorXd observe(const Grey& grey) override;

 private:
  Eigen::VectorXd measure(const Eigen::VectorXd& state);

  const Plant& plant_;
  std::mt19937_64 noise_;
};

/// Goal: that of the goal image. Spread: root of the mean squared distance to the mean of all
/// frames (the length of a pendulum, if x were the tip of one that turns all the way round).
///
///   c(x) = 1 - exp(-|x - goal|^2 / (2 (0.5 spread)^2))
///   p(x_0): mean and scatter of the first frames of all trials, counted together with one more
///           frame at the distance 0.1 spread
///
/// @param X     x of all frames                                                         [D x N]
/// @param goal  x of the goal image                                                         [D]
/// @throws std::runtime_error if all frames are the same
PilcoTask imageTask(const Eigen::MatrixXd& X, const std::vector<Segment>& segments,
                    const Eigen::VectorXd& goal);

/// Learned anew from all data after each trial, so its coordinates change.
class ImageObservation : public Observation {
 public:
  explicit ImageObservation(const ModelConfig& model) : config_(model) {}

  bool keepsCoordinates() const override { return false; }
  PilcoTask task() const override { return *task_; }
  void startTrial(const TrialId& /*id*/) override {}

 protected:
  ModelConfig config_;
  std::optional<PilcoTask> task_;  ///< learn() sets it
};

/// x = z = g^-1(y), 2-D features of one image. The auto-encoder minimises V_R alone
/// (training/schedule v_r_only).
class FeatureObservation : public ImageObservation {
 public:
  /// @throws std::invalid_argument if training/schedule trains more than the auto-encoder
  explicit FeatureObservation(const ModelConfig& model);

  std::vector<std::string> names() const override;
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  void resume(const std::string& folder, const std::vector<std::string>& bags, const DataSet& data,
              const TrialId& id) override;
  std::map<std::string, std::string> files() const override;
  Eigen::VectorXd observe(const Grey& grey) override { return model_->encode(grey); }

 private:
  Eigen::MatrixXd observeAll(const DataSet& data);

  std::optional<Ddm> model_;
};

/// x = PCA scores of one image, model/pca_dim of them (paper, Sec. 4.2: 20).
class PcaObservation : public ImageObservation {
 public:
  using ImageObservation::ImageObservation;

  std::vector<std::string> names() const override;
  Eigen::MatrixXd learn(const std::vector<std::string>& bags, const DataSet& data,
                        const TrialId& id) override;
  Eigen::VectorXd observe(const Grey& grey) override { return projection_(grey); }

 private:
  Projection projection_;
};

/// The policy that PILCO searches, on an observation: u = policy(features of x).
class PilcoPolicy : public Policy {
 public:
  /// @param angles  entries of x that are angles
  PilcoPolicy(std::shared_ptr<Observation> observation,
              std::shared_ptr<pilco::SquashedPolicy> policy, const std::vector<int>& angles)
      : observation_(std::move(observation)),
        policy_(std::move(policy)),
        features_(pilco::replaceAngles(static_cast<int>(observation_->names().size()), angles)) {}

  void startTrial(const TrialId& id) override { observation_->startTrial(id); }
  void observe(const Grey& grey) override { x_ = observation_->observe(grey); }
  /// 0 where the policy's torque is not finite.
  Answer answer() override;
  void apply(const Eigen::VectorXd& /*u*/) override {}

 private:
  std::shared_ptr<Observation> observation_;
  std::shared_ptr<pilco::SquashedPolicy> policy_;
  pilco::Augmentation features_;
  Eigen::VectorXd x_;
};

/// Parameters of the RBF policy of PILCO's first trial: centres drawn from the features of the
/// start distribution, which is taken as Gaussian, small random targets, length-scales of the task.
/// @param features  of the task's state
Eigen::VectorXd drawPolicyStart(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng);

}  // namespace ddm
