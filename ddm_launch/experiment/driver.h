// Interface between Algorithm 1 and the code that runs its trials and trainings.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/policy.h>

#include <Eigen/Core>
#include <boost/filesystem.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ddm {

/// Reports the fraction of a phase that is done, in [0, 1].
using PhaseCallback = std::function<void(double)>;

/// One episode that a driver is asked to run.
struct TrialRequest {
  TrialId id;
  int num_steps = 0;     ///< samples [-]
  double epsilon = 0.0;  ///< probability of a random torque [-]; 1 needs no model
  int hold_steps = 1;    ///< most samples for which an exploratory torque is held [-]
  std::string bag;       ///< path of the recording; empty: the episode is not recorded
};

/// Result of one episode with N images.
struct TrialOutcome {
  std::vector<Eigen::VectorXd> torques;  ///< N vectors [N m]
  std::vector<bool> exploratory;         ///< N flags, true for a random torque
  std::vector<double> solve_times;       ///< one per plan [s]
  std::vector<double> goal_distances;    ///< N values of Policy::goalDistance(); may be empty
  std::vector<double> times;             ///< ground truth: time since the first image [s]
  std::vector<Eigen::VectorXd> states;   ///< ground truth: N states; empty if they are unknown
};

/// Result of one training.
struct TrainingOutcome {
  std::map<std::string, std::string> files;  ///< content of each file to keep, by file name
  std::uint32_t frames = 0;                  ///< samples in the training data [-]
  std::optional<double> v_r;                 ///< V_R [grey^2]; empty if the method has none
  std::optional<double> v_p;                 ///< V_P [grey^2]; empty if the method has none
  double seconds = 0.0;                      ///< wall time of the training [s]
  std::uint32_t evaluations = 0;             ///< evaluations of the objective [-]
};

/// A learner trains models and acts with them. Errors are std::runtime_error; their message names
/// the failure and the remedy.
class Learner {
 public:
  virtual ~Learner() = default;

  /// Trains on all bags and uses the model in all later trials. The folders of the bags hold the
  /// files of earlier trainings.
  /// @param bags      paths of all bags to learn from
  /// @param progress  receives the fraction of the training that is done
  virtual TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                                const PhaseCallback& progress) = 0;

  /// Uses a saved model in all later trials until the next training.
  /// @return false if the method has no models that can be saved; the learner is then unchanged
  virtual bool useModel(const std::string& /*path*/) { return false; }

  /// Restores the learner from the files that an earlier train(bags, id) left in a folder.
  /// @return false if the files do not suffice; the learner is then unchanged
  virtual bool resume(const std::string& folder, const std::vector<std::string>& /*bags*/,
                      const TrialId& /*id*/) {
    const std::string model = folder + "/model.ddm";
    return boost::filesystem::exists(model) && useModel(model);
  }
};

/// A driver also runs the plant, either in this process or through ROS nodes.
class Driver : public Learner {
 public:
  /// Resets the plant and runs one episode with the latest model.
  virtual TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) = 0;
};

}  // namespace ddm
