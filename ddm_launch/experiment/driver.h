// What runs the trials and trainings that Algorithm 1 orders: this process alone, or ROS nodes.
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

/// Fraction of a phase that is done, in [0, 1].
using PhaseCallback = std::function<void(double)>;

struct TrialRequest {
  TrialId id;
  int num_steps = 0;
  double epsilon = 0.0;  ///< 1: random, needs no model
  int hold_steps = 1;
  std::string bag;  ///< where to record; empty: not recorded
};

struct TrialOutcome {
  std::vector<Eigen::VectorXd> torques;  ///< one per frame [N m]
  std::vector<bool> exploratory;         ///< one per frame
  std::vector<double> solve_times;       ///< one per plan [s]
  std::vector<double> goal_distances;    ///< one per frame, see Policy::goalDistance(), or none
  std::vector<double> times;             ///< ground truth: time since the first frame [s]
  std::vector<Eigen::VectorXd> states;   ///< ground truth: state at each frame; empty if unknown
};

struct TrainingOutcome {
  std::map<std::string, std::string> files;  ///< what it leaves behind: content by name
  std::uint32_t frames = 0;                  ///< learned from
  std::optional<double> v_r;                 ///< [grey^2]; empty: the method has none
  std::optional<double> v_p;                 ///< [grey^2]
  double seconds = 0.0;                      ///< wall time of the training [s]
  std::uint32_t evaluations = 0;
};

/// Who learns. Errors are std::runtime_error with what failed and what to do.
class Learner {
 public:
  virtual ~Learner() = default;

  /// Trains on all bags and keeps the model for the trials to come. What an earlier training
  /// left is in the folders of the bags.
  virtual TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                                const PhaseCallback& progress) = 0;

  /// Acts by a saved model in the trials to come, until one is trained.
  /// @return false if it acts by what cannot be saved: nothing has changed
  virtual bool useModel(const std::string& /*path*/) { return false; }

  /// Acts as after train(bags, id), by the files that this training left in a folder.
  /// @return false if they are not enough for that: nothing has changed
  virtual bool resume(const std::string& folder, const std::vector<std::string>& /*bags*/,
                      const TrialId& /*id*/) {
    const std::string model = folder + "/model.ddm";
    return boost::filesystem::exists(model) && useModel(model);
  }
};

class Driver : public Learner {
 public:
  /// Brings the plant to its start and runs one trial, with the last model trained.
  virtual TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) = 0;
};

}  // namespace ddm
