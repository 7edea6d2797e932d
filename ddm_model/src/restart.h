// One of several trainings, with its own initial weights and its own delay.
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

/// Thrown if the callback cancels the training.
struct Cancelled {};

/// Adds up the iterations of all restarts and stages, which may run at the same time.
class Progress {
 public:
  /// @param callback        receives the progress; may be empty
  /// @param max_iterations  cap on the iterations of the whole training
  /// @param squared_scale   factor from [score^2] to [grey^2]
  Progress(const TrainingCallback& callback, double max_iterations, double squared_scale)
      : callback_(callback), max_iterations_(max_iterations), squared_scale_(squared_scale) {}

  /// @return callback for the next stage of one restart
  /// @throws Cancelled if the training was cancelled
  StageCallback nextStage();
  /// Counts the iterations that a stage did not need.
  /// @param skipped_iterations  cap of the stage minus its iterations
  /// @throws Cancelled if the training was cancelled
  void endStage(int skipped_iterations);

 private:
  const TrainingCallback& callback_;
  double max_iterations_;
  double squared_scale_;
  std::mutex mutex_;
  std::atomic<bool> cancelled_{false};
  int iterations_ = 0;    // of all stages
  double skipped_ = 0.0;  // iterations that stages did not need
};

/// Networks with one model/delay, and the objective over their parameters.
struct Problem {
  Problem(ModelOptions model, const TrainingData<float>& data)
      : options(std::move(model)),
        networks(options, static_cast<int>(data.torques.rows())),
        objective(networks, data) {}

  /// @return the selected terms of V, with the factor w
  double cost(const Eigen::VectorXd& theta, const Terms& terms) {
    return objective.weight() * objective.evaluate(theta.cast<float>(), nullptr, terms).of(terms);
  }

  ModelOptions options;
  Networks<float> networks;
  JointObjective<float> objective;
};

/// One training: its initial weights and its result.
struct Restart {
  ModelOptions model;     ///< options with the delay of this restart
  Eigen::VectorXd theta;  ///< initial weights, then current weights  [P]
  double initial_cost = 0.0;
  /// Error by which restarts are compared. Infinite if a stage did not lower the objective.
  double error = std::numeric_limits<double>::infinity();
  std::string message{};  ///< how the solver ended, or why there is no error
  int iterations = 0;
  int evaluations = 0;
};

/// Minimises all stages of the schedule, `finish` excepted, for each restart. Restarts run in
/// parallel on the processors of OpenMP.
/// @throws Cancelled if the training was cancelled; std::invalid_argument if a restart has no
///         predictions to learn from
void minimiseStages(const Schedule& schedule, const TrainingOptions& training,
                    const TrainingData<float>& data, Progress* progress,
                    std::vector<Restart>* restarts);

/// Minimises the last stage for the best restart: first on training/selection_frames samples, then
/// on twice as many at a time, up to all. The first iterations need only few samples.
/// @param longer_than  see evenPart()
/// @throws Cancelled if the training was cancelled
void minimiseFinish(const Stage& finish, const TrainingOptions& training,
                    const TrainingData<float>& data, Eigen::Index longer_than, Progress* progress,
                    Restart* best);

/// Selects parts of segments, spread evenly over all data, and the goal image. A part has up to 100
/// samples.
/// @param max_frames   samples in all parts together at most; below 100, the parts are shorter
/// @param longer_than  parts with at most this many samples are omitted
/// @return             all data if there are at most max_frames samples, or if no part is left
TrainingData<float> evenPart(const TrainingData<float>& data, Eigen::Index max_frames,
                             Eigen::Index longer_than);

}  // namespace ddm
