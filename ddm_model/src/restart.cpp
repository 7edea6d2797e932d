// One of several trainings, with its own initial weights.
// SPDX-License-Identifier: BSD-3-Clause
#include "restart.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

namespace ddm {
namespace {

constexpr Eigen::Index kFirstPart = 200;  // samples of the first part of the data
constexpr Eigen::Index kPiece = 100;      // samples of a piece of a part
constexpr int kWarmUpIterations = 50;     // with k = 1, if k > 1

/// Minimises one stage from the current weights of a restart.
SolverResult minimiseFrom(const Stage& stage, const TrainingOptions& training, Problem* problem,
                          Progress* progress, Restart* restart) {
  SolverResult result = minimiseStage(stage, training, problem->networks, &problem->objective,
                                      &restart->theta, progress->nextStage());
  progress->endStage(stage.max_iterations - result.iterations);
  restart->message = result.message;
  restart->iterations += result.iterations;
  restart->evaluations += result.evaluations;
  return result;
}

/// @return stage with one prediction step that precedes a stage with several, because rollouts of an
///         untrained f have no useful gradient. Without iterations for other stages
Stage warmUpOf(Stage stage) {
  const bool several = stage.terms.v_p && stage.terms.prediction_steps > 1;
  stage.max_iterations = several ? std::min(kWarmUpIterations, stage.max_iterations) : 0;
  stage.terms.prediction_steps = 1;
  return stage;
}

/// Minimises all stages of one restart, the last stage on the parts before numCompared().
void minimiseRestart(const RestartProblem& problem, Progress* progress, Restart* restart) {
  const std::vector<Stage>& stages = problem.schedule.stages;
  const Terms terms = problem.schedule.terms();
  const auto lowered = [&](size_t stage, const SolverResult& result) {
    if (result.improved()) return true;
    restart->message =
        textOf("training did not lower the objective: stage ", stage + 1, " of ", stages.size(),
               " stays at ", result.initial_cost, " (", result.message,
               "); check the bags, or leave the block training at its defaults");
    return false;
  };
  auto networks = std::make_unique<Problem>(problem.model, problem.parts.front());
  if (terms.v_p) networks->objective.requirePredictions();
  for (size_t i = 0; i + 1 < stages.size(); ++i) {
    Problem all(problem.model, problem.parts.back());
    if (!lowered(i, minimiseFrom(stages[i], problem.training, &all, progress, restart))) {
      return;
    }
  }
  for (size_t part = 0; part < problem.numCompared(); ++part) {
    if (part > 0) networks = std::make_unique<Problem>(problem.model, problem.parts[part]);
    const Stage warm_up = warmUpOf(stages.back());
    if (part == 0 && warm_up.max_iterations > 0) {
      minimiseFrom(warm_up, problem.training, networks.get(), progress, restart);
    }
    const SolverResult result =
        minimiseFrom(stages.back(), problem.training, networks.get(), progress, restart);
    if (part == 0 && !lowered(stages.size() - 1, result)) return;
    restart->error = networks->cost(restart->theta, terms);
  }
  if (!std::isfinite(restart->error)) {  // a rollout diverges
    restart->error = std::numeric_limits<double>::max();
  }
}

/// Selects pieces of segments, spread evenly over all data, and the goal image.
/// @param max_frames   samples in all pieces together at most, fewer than there are
/// @param longer_than  pieces with at most this many samples are omitted
/// @return             all data if no piece is left
TrainingData<float> evenPart(const TrainingData<float>& data, Eigen::Index max_frames,
                             Eigen::Index longer_than) {
  const Eigen::Index num_frames = data.torques.cols();
  std::vector<Segment> chosen;
  Eigen::Index seen = 0, taken = 0;
  for (const Segment& segment : data.segments) {
    for (Eigen::Index at = 0; at < segment.size; at += kPiece) {
      const Segment piece{segment.begin + at, std::min(kPiece, segment.size - at)};
      seen += piece.size;
      // A piece is kept if the share of kept samples so far stays at most max_frames / num_frames.
      const bool due = (taken + piece.size) * num_frames <= seen * max_frames;
      if (!due || piece.size <= longer_than) continue;
      taken += piece.size;
      chosen.push_back(piece);
    }
  }
  if (chosen.empty()) return data;
  const Eigen::Index num_others = data.scores.cols() - num_frames;  // 1 if there is a goal image
  TrainingData<float> part;
  part.scores.resize(data.scores.rows(), taken + num_others);
  part.scores.rightCols(num_others) = data.scores.rightCols(num_others);
  part.torques.resize(data.torques.rows(), taken);
  Eigen::Index at = 0;
  for (const Segment& segment : chosen) {
    part.scores.middleCols(at, segment.size) = data.scores.middleCols(segment.begin, segment.size);
    part.torques.middleCols(at, segment.size) =
        data.torques.middleCols(segment.begin, segment.size);
    part.segments.push_back({at, segment.size});
    at += segment.size;
  }
  return part;
}

}  // namespace

StageCallback Progress::nextStage() {
  if (cancelled_) throw Cancelled();
  int before = 0;  // iterations of this stage at the last call
  return [this, before](const SolverResult& so_far,
                        const JointObjective<float>::Value& value) mutable {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (cancelled_) return false;
    iterations_ += so_far.iterations - before;
    before = so_far.iterations;
    if (!callback_) return true;
    TrainingProgress& progress = last_;
    progress.iteration = iterations_;
    progress.v_r = squared_scale_ * value.v_r;
    progress.v_p = squared_scale_ * value.v_p;
    progress.gradient_norm = so_far.gradient.lpNorm<Eigen::Infinity>();
    progress.fraction_done = (skipped_ + iterations_) / max_iterations_;
    cancelled_ = !callback_(progress);
    return !cancelled_;
  };
}

void Progress::endStage(int skipped_iterations) {
  if (cancelled_) throw Cancelled();
  const std::lock_guard<std::mutex> lock(mutex_);
  skipped_ += skipped_iterations;
  last_.fraction_done = (skipped_ + iterations_) / max_iterations_;
}

void Progress::repeat() {
  if (cancelled_) throw Cancelled();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (callback_ && !callback_(last_)) {
    cancelled_ = true;
    throw Cancelled();
  }
}

RestartProblem::RestartProblem(const ModelOptions& model_options,
                               const TrainingOptions& training_options,
                               const TrainingData<float>& data)
    : model(model_options), training(training_options), schedule(makeSchedule(training_options)) {
  const Eigen::Index num_frames = data.torques.cols();
  const Eigen::Index most = training.num_starts > 1 ? num_frames * 2 / 3 : 0;
  for (Eigen::Index count = kFirstPart; count <= most; count *= 2) {
    parts.push_back(evenPart(data, count, model.order));
  }
  parts.push_back(data);
}

size_t RestartProblem::numKept() const {
  return model.predictor == "gp" ? std::max<size_t>(1, training.num_starts / 2) : 1;
}

double RestartProblem::maxIterations() const {
  const auto before = static_cast<double>(schedule.stages.size() - 1);
  const auto compared = static_cast<double>(numCompared());
  const double rest = static_cast<double>(parts.size()) - compared;
  const double stages =
      training.num_starts * (before + compared) + static_cast<double>(numKept()) * rest;
  return stages * training.max_iterations +
         training.num_starts * warmUpOf(schedule.stages.back()).max_iterations;
}

void minimiseRestarts(const RestartProblem& problem, Progress* progress,
                      std::vector<Restart>* restarts) {
  const auto count = static_cast<int>(restarts->size());
  std::vector<std::exception_ptr> errors(restarts->size());  // no exception may leave a thread
  const auto attempt = [&](int i) {
    try {
      minimiseRestart(problem, progress, &(*restarts)[i]);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  };
  // A single restart runs outside of a parallel region: inside, each of its evaluations would start
  // new threads.
  if (count == 1) {
    attempt(0);
  } else {
#pragma omp parallel for schedule(dynamic, 1)
    for (int i = 0; i < count; ++i) attempt(i);
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void finish(const RestartProblem& problem, Progress* progress, Restart* restart) {
  for (size_t part = problem.numCompared(); part < problem.parts.size(); ++part) {
    Problem networks(problem.model, problem.parts[part]);
    minimiseFrom(problem.schedule.stages.back(), problem.training, &networks, progress, restart);
  }
}

}  // namespace ddm
