// Training: PCA, initial parameters, then the stages of a schedule minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <ddm_random/random_stream.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ddm_model/initialisation.h"
#include "ddm_model/landmarks.h"
#include "ddm_model/objective.h"
#include "ddm_model/pca.h"
#include "ddm_model/schedule.h"
#include "ddm_model/training_data.h"
#include "stage_minimisation.h"

namespace ddm {
namespace {

using Value = JointObjective<float>::Value;

constexpr Eigen::Index kMaxLandmarks = 1000;

/// @return what turns [score^2] into [grey^2]
double squaredScale(const Pca& pca) { return 1.0 / (static_cast<double>(pca.scale) * pca.scale); }

/// @return cap on the iterations of all stages together
int iterationCap(const std::vector<Stage>& stages) {
  return std::accumulate(stages.begin(), stages.end(), 0,
                         [](int sum, const Stage& stage) { return sum + stage.max_iterations; });
}

/// All starts and stages as one progress, whichever of them run at the same time.
class Progress {
 public:
  Progress(const TrainingCallback& callback, const Schedule& schedule, size_t num_starts,
           const Pca& pca)
      : callback_(callback),
        cap_(static_cast<double>(num_starts) * iterationCap(schedule.stages) +
             (schedule.finish ? schedule.finish->max_iterations : 0)),
        squared_scale_(squaredScale(pca)) {}

  /// @return what is to be called while the next stage of one start is minimised
  StageCallback ofStage() {
    int before = 0;  // iterations of this stage at the last call
    return [this, before](const Minimum& so_far, const Value& value) mutable {
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
      progress.fraction_done = (skipped_ + iterations_) / cap_;
      cancelled_ = !callback_(progress);
      return !cancelled_;
    };
  }

  /// A stage ended before its cap.
  void skip(int iterations) {
    const std::lock_guard<std::mutex> lock(mutex_);
    skipped_ += iterations;
  }

  bool cancelled() const { return cancelled_; }

 private:
  const TrainingCallback& callback_;
  double cap_;  // on the iterations of the whole training
  double squared_scale_;
  std::mutex mutex_;
  std::atomic<bool> cancelled_{false};
  int iterations_ = 0;    // of all stages
  double skipped_ = 0.0;  // that no stage will need any more
};

/// The terms that the best start is chosen by: predictions training/selection_steps ahead, or what
/// the schedule minimises.
Terms selectionTerms(const Schedule& schedule, const TrainingOptions& training) {
  if (training.selection_steps == 0) return schedule.terms();
  Terms terms{false, true};
  terms.prediction_steps = training.selection_steps;
  return terms;
}

/// What is minimised for one model/delay.
struct Problem {
  Problem(ModelOptions model, const TrainingData<float>& data)
      : options(std::move(model)),
        networks(options, static_cast<int>(data.torques.rows())),
        objective(networks, data),
        num_frames(data.torques.cols()) {}

  ModelOptions options;
  Networks<float> networks;
  JointObjective<float> objective;
  Eigen::Index num_frames;

  /// w times the terms.
  double cost(const Eigen::VectorXd& theta, const Terms& terms) {
    return objective.weight() * objective.evaluate(theta.cast<float>(), nullptr, terms).of(terms);
  }

  /// The same with as many predictions as there are frames, so that delays can be compared: a longer
  /// one leaves fewer predictions, but as many images and weights.
  double errorOfAllFrames(const Eigen::VectorXd& theta, const Terms& terms) {
    Value value = objective.evaluate(theta.cast<float>(), nullptr, terms);
    const auto num_predictions = static_cast<double>(objective.numPredictions());
    if (terms.v_p) value.v_p *= static_cast<double>(num_frames) / num_predictions;
    return objective.weight() * value.of(terms);
  }
};

/// One start with one delay, and what it came to.
struct Candidate {
  ModelOptions model;
  Eigen::VectorXd theta;
  double initial_cost = 0.0;
  double error =
      std::numeric_limits<double>::infinity();  ///< of a prediction; infinite: nothing usable
  std::string message;                          ///< how the solver ended
  int iterations = 0;
  int evaluations = 0;
  std::exception_ptr refusal;  ///< of its data
};

/// The largest delay that is tried: up to training/max_delay, as long as there is something to predict.
int largestDelayOf(const DataSet& data, const ModelOptions& model,
                   const TrainingOptions& training) {
  Eigen::Index longest = 0;
  for (const Segment& segment : data.segments()) longest = std::max(longest, segment.size);
  const auto possible = static_cast<int>(longest) - 1 - model.order;
  return std::max(model.delay, std::min(largestDelay(model, training), possible));
}

/// Each start with each delay that is tried.
std::vector<Candidate> makeCandidates(const ModelOptions& model, int largest_delay,
                                      const std::vector<Eigen::VectorXd>& starts) {
  std::vector<Candidate> candidates;
  for (const Eigen::VectorXd& theta : starts) {
    for (int delay = model.delay; delay <= largest_delay; ++delay) {
      candidates.emplace_back();
      candidates.back().model = model;
      candidates.back().model.delay = delay;
      candidates.back().theta = theta;
    }
  }
  return candidates;
}

/// Minimises one stage from where the candidate is.
Minimum runStage(const Stage& stage, const TrainingOptions& training, Problem* problem,
                 Progress* progress, Candidate* candidate) {
  Minimum minimum = minimiseStage(stage, training, problem->networks, &problem->objective,
                                  &candidate->theta, progress->ofStage());
  progress->skip(stage.max_iterations - minimum.iterations);
  candidate->message = minimum.message;
  candidate->iterations += minimum.iterations;
  candidate->evaluations += minimum.evaluations;
  return minimum;
}

/// All stages of one candidate. Its error is infinite afterwards if there is no usable minimum; the message says why.
void run(const Schedule& schedule, const TrainingOptions& training, const TrainingData<float>& data,
         Progress* progress, Candidate* candidate) {
  if (progress->cancelled()) return;
  Problem problem(candidate->model, data);
  const Terms selection = selectionTerms(schedule, training);
  if (schedule.terms().v_p || selection.v_p) problem.objective.requirePredictions();
  candidate->initial_cost = problem.cost(candidate->theta, schedule.terms());
  const std::vector<Stage>& stages = schedule.stages;
  for (size_t i = 0; i < stages.size(); ++i) {
    const Minimum minimum = runStage(stages[i], training, &problem, progress, candidate);
    if (progress->cancelled()) return;
    if (!minimum.improved()) {
      std::ostringstream text;
      text << "training did not lower the objective: stage " << i + 1 << " of " << stages.size()
           << " stays at " << minimum.initial_cost << " (" << minimum.message
           << "); check the bags, or leave the block training at its defaults";
      candidate->message = text.str();
      return;
    }
  }
  candidate->error = problem.errorOfAllFrames(candidate->theta, selection);
  if (!std::isfinite(candidate->error)) {  // a roll-out that grows without bound
    candidate->error = std::numeric_limits<double>::max();
  }
}

/// All candidates, on as many processors as OpenMP may use.
/// @throws what the first of those threw that refused its data
void runAll(const Schedule& schedule, const TrainingOptions& training,
            const TrainingData<float>& data, Progress* progress,
            std::vector<Candidate>* candidates) {
  const auto attempt = [&](Candidate* candidate) {
    try {  // no exception may leave a thread
      run(schedule, training, data, progress, candidate);
    } catch (...) {
      candidate->refusal = std::current_exception();
    }
  };
  const auto count = static_cast<int>(candidates->size());
  // In a team of one thread its objective would start new threads at each evaluation.
  if (count == 1) {
    attempt(&candidates->front());
  } else {
#pragma omp parallel for schedule(dynamic, 1)
    for (int i = 0; i < count; ++i) attempt(&(*candidates)[i]);
  }
  for (const Candidate& candidate : *candidates) {
    if (candidate.refusal) std::rethrow_exception(candidate.refusal);
  }
}

/// Numbers of frames that the chosen start goes on with: twice as many each time, up to all. What can be learned from few
/// need not be learned from all.
/// @param first  training/selection_frames; 0: all at once
std::vector<Eigen::Index> growingFrames(Eigen::Index first, Eigen::Index all) {
  std::vector<Eigen::Index> counts;
  if (first > 0) {
    for (Eigen::Index count = first; count < all; count *= 2) counts.push_back(count);
  }
  counts.push_back(all);
  return counts;
}

/// Minimises schedule.finish on more and more frames, about as many iterations on each.
/// @param best  in: the start that was chosen, out: what it came to
/// @return      the problem of all frames
std::unique_ptr<Problem> finish(const Schedule& schedule, const TrainingOptions& training,
                                const TrainingData<float>& data, Eigen::Index longer_than,
                                Progress* progress, Candidate* best) {
  if (!schedule.finish) return std::make_unique<Problem>(best->model, data);
  std::unique_ptr<Problem> problem;
  const std::vector<Eigen::Index> counts =
      growingFrames(training.selection_frames, data.torques.cols());
  int rest = schedule.finish->max_iterations;
  for (size_t i = 0; i < counts.size() && !progress->cancelled(); ++i) {
    problem = std::make_unique<Problem>(best->model, evenPart(data, counts[i], longer_than));
    Stage stage = *schedule.finish;
    stage.max_iterations = rest / static_cast<int>(counts.size() - i);
    rest -= stage.max_iterations;
    if (stage.max_iterations > 0) runStage(stage, training, problem.get(), progress, best);
  }
  return problem;
}

/// Makes the model of a candidate that is done.
/// @param problem  of all frames
void fillIn(Problem* problem, const Candidate& best, const DataSet& data, const Pca& pca,
            const Schedule& schedule, ModelInfo info, TrainingResult* result) {
  result->initial_cost = best.initial_cost;
  result->final_cost = problem->cost(best.theta, schedule.terms());
  const Value value = problem->objective.evaluate(best.theta.cast<float>(), nullptr);
  info.frames = static_cast<std::uint32_t>(data.numFrames());
  info.v_r = squaredScale(pca) * value.v_r;
  info.v_p = squaredScale(pca) * value.v_p;
  info.feature_spread = problem->objective.featureSpread();
  info.landmarks =
      landmarkStates(problem->objective.features(), data, problem->options.memory(), kMaxLandmarks);
  result->model.emplace(problem->options, data.imageSize(), data.torqueDim(), pca, best.theta,
                        data.goal(), info);
}

/// Thrown before there is an iteration.
struct Cancelled {};

/// See train(). @throws Cancelled also
TrainingResult trainUnlessCancelled(const DataSet& data, const ModelOptions& model,
                                    const TrainingOptions& training, ModelInfo info,
                                    const TrainingCallback& callback) {
  const Networks<double> initial_networks(model, data.torqueDim());
  const Pca pca =
      fitPca(data, model.pca_dim, training.score_std, Blur(data.imageSize(), model.blur), [&] {
        if (callback && !callback(TrainingProgress())) throw Cancelled();
      });
  const TrainingData<float> training_data = makeTrainingData(data, pca);
  const Eigen::MatrixXd scores = training_data.scores.cast<double>();
  const Schedule schedule = makeSchedule(training);
  std::mt19937_64 rng = randomStream({info.seed, info.trial}, StreamRole::kInitialisation);
  std::vector<Eigen::VectorXd> starts;
  for (int i = 0; i < training.num_starts; ++i) {
    starts.push_back(initialTheta(initial_networks, scores, training, schedule.pca_start, &rng));
  }
  const int largest_delay = largestDelayOf(data, model, training);
  std::vector<Candidate> candidates = makeCandidates(model, largest_delay, starts);
  Progress progress(callback, schedule, candidates.size(), pca);
  const int longer_than = model.order + largest_delay;
  runAll(schedule, training,
         schedule.finish && training.selection_frames > 0
             ? evenPart(training_data, training.selection_frames, longer_than)
             : training_data,
         &progress, &candidates);

  TrainingResult result;
  Candidate& best =
      *std::min_element(candidates.begin(), candidates.end(),
                        [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
  if (std::isfinite(best.error) && !progress.cancelled()) {
    const std::unique_ptr<Problem> problem =
        finish(schedule, training, training_data, longer_than, &progress, &best);
    if (!progress.cancelled()) {
      fillIn(problem.get(), best, data, pca, schedule, std::move(info), &result);
      const ModelInfo& errors = result.model->info();
      if (!std::isfinite(errors.v_r + errors.v_p)) {
        std::ostringstream text;
        text << "the errors of the model must be finite, got V_R " << errors.v_r << " and V_P "
             << errors.v_p << ": check the bags, or leave the block training at its defaults";
        best.message = text.str();
        result.model.reset();
        result.final_cost = 0.0;
      }
    }
  }
  for (const Candidate& candidate : candidates) {
    result.iterations += candidate.iterations;
    result.evaluations += candidate.evaluations;
  }
  result.message = best.message;
  result.cancelled = progress.cancelled();
  return result;
}

}  // namespace

TrainingResult train(const DataSet& data, const ModelOptions& model,
                     const TrainingOptions& training, ModelInfo info,
                     const TrainingCallback& callback) {
  const auto began = std::chrono::steady_clock::now();
  TrainingResult result;
  try {
    result = trainUnlessCancelled(data, model, training, std::move(info), callback);
  } catch (const Cancelled&) {
    result.cancelled = true;
  }
  if (result.cancelled) result.message = "training was cancelled";
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return result;
}

}  // namespace ddm
