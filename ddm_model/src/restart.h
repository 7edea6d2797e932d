// One of several trainings: from its own initial weights, with one delay.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "ddm_model/objective.h"
#include "ddm_model/schedule.h"
#include "ddm_model/trainer.h"
#include "stage_minimisation.h"

namespace ddm {

/// Thrown where the callback of a training ends it.
struct Cancelled {};

/// The iterations of all restarts and stages as one progress, whichever of them run at the same time.
class Progress {
 public:
  /// @param max_iterations  of the whole training
  /// @param squared_scale   turns [score^2] into [grey^2]
  Progress(const TrainingCallback& callback, double max_iterations, double squared_scale)
      : callback_(callback), max_iterations_(max_iterations), squared_scale_(squared_scale) {}

  /// @return what is to be called while the next stage of one restart is minimised
  /// @throws Cancelled if the callback has ended the training
  StageCallback nextStage();
  /// The stage ended, perhaps before its limit. @throws Cancelled likewise
  void endStage(int skipped_iterations);

 private:
  const TrainingCallback& callback_;
  double max_iterations_;
  double squared_scale_;
  std::mutex mutex_;
  std::atomic<bool> cancelled_{false};
  int iterations_ = 0;    // of all stages
  double skipped_ = 0.0;  // that no stage will need any more
};

/// The networks with one model/delay, and what is minimised over their parameters.
struct Problem {
  Problem(ModelOptions model, const TrainingData<float>& data)
      : options(std::move(model)),
        networks(options, static_cast<int>(data.torques.rows())),
        objective(networks, data) {}

  /// w times the terms.
  double cost(const Eigen::VectorXd& theta, const Terms& terms) {
    return objective.weight() * objective.evaluate(theta.cast<float>(), nullptr, terms).of(terms);
  }

  ModelOptions options;
  Networks<float> networks;
  JointObjective<float> objective;
};

/// What one training started from, and what it came to.
struct Restart {
  ModelOptions model;     ///< with the delay of this restart
  Eigen::VectorXd theta;  ///< initial weights, then those reached  [P]
  double initial_cost = 0.0;
  /// By which restarts are compared; infinite: the objective did not fall, and the message says so.
  double error = std::numeric_limits<double>::infinity();
  std::string message{};  ///< how the solver ended
  int iterations = 0;
  int evaluations = 0;
};

/// Minimises the stages of the schedule for all restarts, on as many processors as OpenMP may use.
/// @throws Cancelled; what the first restart threw that refused its data
void minimiseStages(const Schedule& schedule, const TrainingOptions& training,
                    const TrainingData<float>& data, Progress* progress,
                    std::vector<Restart>* restarts);

/// Minimises the last stage of a schedule for the restart that was chosen, first on training/selection_frames,
/// then on twice as many frames each time, up to all: what can be learned from few need not be learned from all.
/// @param longer_than  see evenPart()
/// @throws Cancelled
void minimiseFinish(const Stage& finish, const TrainingOptions& training,
                    const TrainingData<float>& data, Eigen::Index longer_than, Progress* progress,
                    Restart* best);

/// Parts of segments of up to 100 frames, spread evenly over all and at most so many frames together, and the goal.
/// @param max_frames   more than there are: all; fewer than 100: the parts are shorter
/// @param longer_than  parts that are not longer are left out [frames]
/// @return             all of the data, if no part is long enough
TrainingData<float> evenPart(const TrainingData<float>& data, Eigen::Index max_frames,
                             Eigen::Index longer_than);

}  // namespace ddm
