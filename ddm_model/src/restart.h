// One of several trainings, with its own initial weights.
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
  /// Reports the last progress again, while something else is computed.
  /// @throws Cancelled if the training was cancelled
  void repeat();

 private:
  const TrainingCallback& callback_;
  double max_iterations_;
  double squared_scale_;
  std::mutex mutex_;
  std::atomic<bool> cancelled_{false};
  int iterations_ = 0;    // of all stages
  double skipped_ = 0.0;  // iterations that stages did not need
  TrainingProgress last_;
};

/// Networks, and the objective over their parameters.
struct Problem {
  Problem(const ModelOptions& model, const TrainingData<float>& data)
      : networks(model, static_cast<int>(data.torques.rows())), objective(networks, data) {}

  /// @return the selected terms of V, with the factor w
  double cost(const Eigen::VectorXd& theta, const Terms& terms) {
    return objective.weight() * objective.evaluate(theta.cast<float>(), nullptr, terms).of(terms);
  }

  Networks<float> networks;
  JointObjective<float> objective;
};

/// One training: its initial weights and its result.
struct Restart {
  Eigen::VectorXd theta;  ///< initial weights, then current weights  [P]
  /// Objective on the last part of the data so far. Infinite if a stage did not lower it.
  double error = std::numeric_limits<double>::infinity();
  std::string message{};  ///< how the solver ended, or why there is no error
  int iterations = 0;
  int evaluations = 0;
};

/// Options, schedule and data that all restarts of a training share.
struct RestartProblem {
  ModelOptions model;
  TrainingOptions training;
  Schedule schedule;
  /// Parts of the data on which the last stage is minimised one after the other. A later part
  /// contains twice as many samples, so that the iterations grow with the logarithm of the number
  /// of samples, and most of them need only few samples. The last part contains all samples, and
  /// the part before it at most two thirds of them: a larger part would hardly differ from all.
  std::vector<TrainingData<float>> parts;

  /// @param data  all samples. A single restart has one part, all samples
  RestartProblem(const ModelOptions& model, const TrainingOptions& training,
                 const TrainingData<float>& data);

  /// Number of parts after which restarts are compared: all but the last, or the only one. The
  /// comparison must come late: after 800 or 1,600 of the 5,500 samples of the cart-pole, it does not
  /// find the restart that predicts best in the end, whose errors are half of those of the worst.
  size_t numCompared() const { return parts.size() > 1 ? parts.size() - 1 : 1; }
  /// Number of restarts that continue on all samples. A Gaussian process predicts the joined
  /// features of several restarts better than those of one, because the errors of their encoders
  /// are independent. A network f belongs to the features of one restart.
  size_t numKept() const;
  /// @return cap on the iterations of the whole training
  double maxIterations() const;
};

/// Minimises all stages for each restart, the last stage on the parts before numCompared(). Restarts
/// run in parallel on the processors of OpenMP.
/// @throws Cancelled if the training was cancelled; std::invalid_argument if there are no
///         predictions to learn from
void minimiseRestarts(const RestartProblem& problem, Progress* progress,
                      std::vector<Restart>* restarts);

/// Minimises the last stage for one of the best restarts on the parts from numCompared() on.
/// @throws Cancelled if the training was cancelled
void finish(const RestartProblem& problem, Progress* progress, Restart* restart);

}  // namespace ddm
