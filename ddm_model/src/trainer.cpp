// Training: PCA, initial parameters, then the stages of a schedule minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <ddm_msgs/random_stream.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
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

/// All starts and stages as one progress.
class Progress {
 public:
  Progress(const TrainingCallback& callback, const Schedule& schedule, int num_starts,
           const Pca& pca)
      : callback_(callback),
        cap_(static_cast<double>(num_starts) * iterationCap(schedule.stages) +
             (schedule.finish ? schedule.finish->max_iterations : 0)),
        squared_scale_(squaredScale(pca)) {}

  /// The next stage.
  /// @param cap         on its iterations
  /// @param iterations  of all stages before
  /// @return            what is to be called while it is minimised
  StageCallback ofStage(int cap, int iterations) {
    const double before = caps_before_;
    caps_before_ += cap;
    if (!callback_) return nullptr;
    return [this, before, iterations](const Minimum& so_far, const Value& value) {
      TrainingProgress progress;
      progress.iteration = iterations + so_far.iterations;
      progress.v_r = squared_scale_ * value.v_r;
      progress.v_p = squared_scale_ * value.v_p;
      progress.gradient_norm = so_far.gradient.lpNorm<Eigen::Infinity>();
      progress.fraction_done = (before + so_far.iterations) / cap_;
      return callback_(progress);
    };
  }

 private:
  const TrainingCallback& callback_;
  double cap_;  // on the iterations of the whole training
  double caps_before_ = 0.0;
  double squared_scale_;
};

/// Minimises one stage.
/// @param theta   in: initial parameters, out: the minimum
/// @param result  out: message, cancelled; iterations and evaluations are added
Minimum runStage(const Stage& stage, const TrainingOptions& training,
                 const Networks<float>& networks, Progress* progress,
                 JointObjective<float>* objective, Eigen::VectorXd* theta, TrainingResult* result) {
  Minimum minimum = minimiseStage(stage, training, networks, objective, theta,
                                  progress->ofStage(stage.max_iterations, result->iterations));
  result->message = minimum.message;
  result->iterations += minimum.iterations;
  result->evaluations += minimum.evaluations;
  if (minimum.reason == MinimumReason::kStopped) {
    result->message = "training was cancelled";
    result->cancelled = true;
  }
  return minimum;
}

/// Minimises the stages one after the other.
/// @return false if there is no usable minimum; the message says why
bool runStages(const std::vector<Stage>& stages, const TrainingOptions& training,
               const Networks<float>& networks, Progress* progress,
               JointObjective<float>* objective, Eigen::VectorXd* theta, TrainingResult* result) {
  for (size_t i = 0; i < stages.size(); ++i) {
    const Minimum minimum =
        runStage(stages[i], training, networks, progress, objective, theta, result);
    if (result->cancelled) return false;
    if (!minimum.improved()) {
      std::ostringstream text;
      text << "training did not lower the objective: stage " << i + 1 << " of " << stages.size()
           << " stays at " << minimum.initial_cost << " (" << minimum.message
           << "); check the bags, or leave the block training at its defaults";
      result->message = text.str();
      return false;
    }
  }
  return true;
}

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
  Problem(ModelOptions model, int torque_dim, const TrainingData<float>& data)
      : options(std::move(model)), networks(options, torque_dim), objective(networks, data) {}

  ModelOptions options;
  Networks<float> networks;
  JointObjective<float> objective;

  /// w times the terms.
  double cost(const Eigen::VectorXd& theta, const Terms& terms) {
    return objective.weight() * objective.evaluate(theta.cast<float>(), nullptr, terms).of(terms);
  }
};

/// One for each delay that is tried.
std::vector<std::unique_ptr<Problem>> makeProblems(ModelOptions model,
                                                   const TrainingOptions& training, int torque_dim,
                                                   const TrainingData<float>& data) {
  std::vector<std::unique_ptr<Problem>> problems;
  const int last = largestDelay(model, training);
  for (; model.delay <= last; ++model.delay) {
    problems.push_back(std::make_unique<Problem>(model, torque_dim, data));
  }
  return problems;
}

/// What one start came to.
struct Candidate {
  Problem* problem = nullptr;
  Eigen::VectorXd theta;  ///< empty: nothing usable
  double initial_cost = 0.0;
  double error = std::numeric_limits<double>::infinity();  ///< of a prediction; less is better
  std::string message;                                     ///< how the solver ended
};

/// One start for one delay, all stages.
/// @param result  as of runStage()
Candidate run(Problem* problem, Eigen::VectorXd initial_theta, const Schedule& schedule,
              const TrainingOptions& training, Progress* progress, TrainingResult* result) {
  Candidate candidate;
  candidate.problem = problem;
  candidate.theta = std::move(initial_theta);
  candidate.initial_cost = problem->cost(candidate.theta, schedule.terms());
  if (!runStages(schedule.stages, training, problem->networks, progress, &problem->objective,
                 &candidate.theta, result)) {
    return {};
  }
  // A longer delay leaves fewer predictions to learn from.
  candidate.error = problem->cost(candidate.theta, selectionTerms(schedule, training)) /
                    static_cast<double>(problem->objective.numPredictions());
  if (!std::isfinite(candidate.error)) {  // a roll-out that grows without bound
    candidate.error = std::numeric_limits<double>::max();
  }
  candidate.message = result->message;
  return candidate;
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
/// @param best    in: the start that was chosen, out: what it came to
/// @param result  as of runStage()
/// @return        the problem of all frames
std::unique_ptr<Problem> finish(const Schedule& schedule, const TrainingOptions& training,
                                const TrainingData<float>& data, Eigen::Index longer_than,
                                Progress* progress, Candidate* best, TrainingResult* result) {
  const int torque_dim = static_cast<int>(data.torques.rows());
  const ModelOptions& model = best->problem->options;
  if (!schedule.finish) return std::make_unique<Problem>(model, torque_dim, data);
  std::unique_ptr<Problem> problem;
  const std::vector<Eigen::Index> counts =
      growingFrames(training.selection_frames, data.torques.cols());
  int rest = schedule.finish->max_iterations;
  for (size_t i = 0; i < counts.size() && !result->cancelled; ++i) {
    problem = std::make_unique<Problem>(model, torque_dim, evenPart(data, counts[i], longer_than));
    Stage stage = *schedule.finish;
    stage.max_iterations = rest / static_cast<int>(counts.size() - i);
    rest -= stage.max_iterations;
    if (stage.max_iterations == 0) continue;
    runStage(stage, training, problem->networks, progress, &problem->objective, &best->theta,
             result);
    best->message = result->message;
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

}  // namespace

TrainingResult train(const DataSet& data, const ModelOptions& model,
                     const TrainingOptions& training, ModelInfo info,
                     const TrainingCallback& callback) {
  const auto began = std::chrono::steady_clock::now();
  const Networks<double> initial_networks(model, data.torqueDim());
  const Pca pca =
      fitPca(data, model.pca_dim, training.score_std, Blur(data.imageSize(), model.blur));
  const TrainingData<float> training_data = makeTrainingData(data, pca);
  const int longer_than = model.order + largestDelay(model, training);
  const auto problems =
      makeProblems(model, training, data.torqueDim(),
                   training.selection_frames > 0
                       ? evenPart(training_data, training.selection_frames, longer_than)
                       : training_data);
  const Eigen::MatrixXd scores = training_data.scores.cast<double>();
  const Schedule schedule = makeSchedule(training);
  Progress progress(callback, schedule, training.num_starts * static_cast<int>(problems.size()),
                    pca);
  std::mt19937_64 rng = randomStream({info.seed, info.trial}, StreamRole::kInitialisation);

  TrainingResult result;
  Candidate best;
  for (int start = 0; start < training.num_starts && !result.cancelled; ++start) {
    const Eigen::VectorXd initial_theta =
        initialTheta(initial_networks, scores, training, schedule.pca_start, &rng);
    for (size_t i = 0; i < problems.size() && !result.cancelled; ++i) {
      Candidate candidate =
          run(problems[i].get(), initial_theta, schedule, training, &progress, &result);
      if (candidate.error < best.error) best = std::move(candidate);
    }
  }
  if (best.theta.size() > 0 && !result.cancelled) {
    const std::unique_ptr<Problem> problem =
        finish(schedule, training, training_data, longer_than, &progress, &best, &result);
    if (!result.cancelled) {
      result.message = best.message;
      fillIn(problem.get(), best, data, pca, schedule, std::move(info), &result);
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return result;
}

}  // namespace ddm
