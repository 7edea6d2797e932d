// One of several trainings, with its own initial weights and its own delay.
// SPDX-License-Identifier: BSD-3-Clause
#include "restart.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <sstream>

namespace ddm {
namespace {

constexpr Eigen::Index kPart = 100;    // samples of a part
constexpr Eigen::Index kMinParts = 4;  // for few samples, so that they come from several places

/// @return terms for the comparison of restarts: predictions training/selection_steps ahead, or the
///         terms that the schedule minimises
Terms selectionTerms(const Schedule& schedule, const TrainingOptions& training) {
  if (training.selection_steps == 0) return schedule.terms();
  Terms terms{false, true};
  terms.prediction_steps = training.selection_steps;
  return terms;
}

/// Minimises one stage from the current weights of a restart.
Minimum minimiseFrom(const Stage& stage, const TrainingOptions& training, Problem* problem,
                     Progress* progress, Restart* restart) {
  Minimum minimum = minimiseStage(stage, training, problem->networks, &problem->objective,
                                  &restart->theta, progress->nextStage());
  progress->endStage(stage.max_iterations - minimum.iterations);
  restart->message = minimum.message;
  restart->iterations += minimum.iterations;
  restart->evaluations += minimum.evaluations;
  return minimum;
}

/// Minimises all stages of one restart, and computes the error by which restarts are compared.
void minimiseRestart(const Schedule& schedule, const TrainingOptions& training,
                     const TrainingData<float>& data, Progress* progress, Restart* restart) {
  Problem problem(restart->model, data);
  const Terms selection = selectionTerms(schedule, training);
  if (schedule.terms().v_p || selection.v_p) problem.objective.requirePredictions();
  restart->initial_cost = problem.cost(restart->theta, schedule.terms());
  const std::vector<Stage>& stages = schedule.stages;
  for (size_t i = 0; i < stages.size(); ++i) {
    const Minimum minimum = minimiseFrom(stages[i], training, &problem, progress, restart);
    if (minimum.improved()) continue;
    std::ostringstream text;
    text << "training did not lower the objective: stage " << i + 1 << " of " << stages.size()
         << " stays at " << minimum.initial_cost << " (" << minimum.message
         << "); check the bags, or leave the block training at its defaults";
    restart->message = text.str();
    return;
  }
  // Scale V_P to the number of samples, to compare delays: a longer delay leaves fewer predictions,
  // but the same number of images and weights.
  auto value = problem.objective.evaluate(restart->theta.cast<float>(), nullptr, selection);
  const auto num_predictions = static_cast<double>(problem.objective.numPredictions());
  if (selection.v_p) value.v_p *= static_cast<double>(data.torques.cols()) / num_predictions;
  restart->error = problem.objective.weight() * value.of(selection);
  if (!std::isfinite(restart->error)) {  // a rollout diverges
    restart->error = std::numeric_limits<double>::max();
  }
}

}  // namespace

StageCallback Progress::nextStage() {
  if (cancelled_) throw Cancelled();
  int before = 0;  // iterations of this stage at the last call
  return [this, before](const Minimum& so_far, const JointObjective<float>::Value& value) mutable {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (cancelled_) return false;
    iterations_ += so_far.iterations - before;
    before = so_far.iterations;
    if (!callback_) return true;
    TrainingProgress progress;
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
}

void minimiseStages(const Schedule& schedule, const TrainingOptions& training,
                    const TrainingData<float>& data, Progress* progress,
                    std::vector<Restart>* restarts) {
  const auto count = static_cast<int>(restarts->size());
  std::vector<std::exception_ptr> errors(restarts->size());  // no exception may leave a thread
  const auto attempt = [&](int i) {
    try {
      minimiseRestart(schedule, training, data, progress, &(*restarts)[i]);
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

void minimiseFinish(const Stage& finish, const TrainingOptions& training,
                    const TrainingData<float>& data, Eigen::Index longer_than, Progress* progress,
                    Restart* best) {
  const Eigen::Index num_frames = data.torques.cols();
  std::vector<Eigen::Index> counts;
  for (Eigen::Index count = training.selection_frames; 0 < count && count < num_frames;) {
    counts.push_back(count);
    count *= 2;
  }
  counts.push_back(num_frames);
  int rest = finish.max_iterations;
  for (size_t i = 0; i < counts.size(); ++i) {
    Problem problem(best->model, evenPart(data, counts[i], longer_than));
    Stage stage = finish;
    stage.max_iterations = rest / static_cast<int>(counts.size() - i);  // in equal shares
    rest -= stage.max_iterations;
    if (stage.max_iterations > 0) minimiseFrom(stage, training, &problem, progress, best);
  }
}

TrainingData<float> evenPart(const TrainingData<float>& data, Eigen::Index max_frames,
                             Eigen::Index longer_than) {
  const Eigen::Index num_frames = data.torques.cols();
  if (num_frames <= max_frames) return data;
  // Fewer than 100 samples could not be spread over several places in parts of 100.
  const Eigen::Index length =
      max_frames >= kPart ? kPart : std::max(longer_than + 1, max_frames / kMinParts);
  std::vector<Segment> chosen;
  Eigen::Index seen = 0, taken = 0;
  for (const Segment& segment : data.segments) {
    for (Eigen::Index at = 0; at < segment.size; at += length) {
      const Segment piece{segment.begin + at, std::min(length, segment.size - at)};
      seen += piece.size;
      // A part is kept if the share of kept samples so far stays at most max_frames / num_frames.
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

}  // namespace ddm
