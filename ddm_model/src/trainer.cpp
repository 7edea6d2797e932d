// Training: PCA, initial parameters, then the stages of a schedule minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "ddm_model/initialisation.h"
#include "ddm_model/minimise.h"
#include "ddm_model/objective.h"
#include "ddm_model/pca.h"
#include "ddm_model/schedule.h"
#include "ddm_model/training_data.h"

namespace ddm {
namespace {

constexpr std::uint32_t kInitialisationRole = 2;

/// Where the parameters that a stage may change lie in theta.
struct Range {
  Eigen::Index begin;
  Eigen::Index size;
};

Range freeParameters(const Networks<float>& networks, Stage::Free free) {
  const Eigen::Index num_params = networks.numParams();
  const Eigen::Index num_auto_encoder = num_params - networks.f().numParams();
  switch (free) {
    case Stage::Free::kAutoEncoder:
      return {0, num_auto_encoder};
    case Stage::Free::kPredictor:
      return {num_auto_encoder, num_params - num_auto_encoder};
    case Stage::Free::kAll:
      break;
  }
  return {0, num_params};
}

/// The scaled objective of one stage in float32, as a function of the free parameters.
class StageObjective {
 public:
  using Value = JointObjective<float>::Value;

  /// @param theta  all parameters; gives the values of those that are not free
  StageObjective(JointObjective<float>* objective, const Terms& terms, Range free,
                 const Eigen::VectorXd& theta)
      : objective_(*objective), terms_(terms), free_(free), theta_(theta.cast<float>()) {}

  double operator()(const Eigen::VectorXd& free, Eigen::VectorXd* gradient) {
    theta_.segment(free_.begin, free_.size) = free.cast<float>();
    const Value value =
        objective_.evaluate(theta_, gradient != nullptr ? &d_theta_ : nullptr, terms_);
    const double cost = objective_.weight() * value.of(terms_);
    if (gradient != nullptr) {
      *gradient = objective_.weight() * d_theta_.segment(free_.begin, free_.size).cast<double>();
    }
    if (cost < lowest_) {
      lowest_ = cost;
      best_ = value;
    }
    return cost;
  }

  /// V_R and V_P where the cost was lowest.
  const Value& best() const { return best_; }

 private:
  JointObjective<float>& objective_;
  Terms terms_;
  Range free_;
  Eigen::VectorXf theta_;
  Eigen::VectorXf d_theta_;
  double lowest_ = std::numeric_limits<double>::infinity();
  Value best_;
};

/// @return what turns [score^2] into [grey^2]
double squaredScale(const Pca& pca) { return 1.0 / (static_cast<double>(pca.scale) * pca.scale); }

/// The stages of a schedule, one after the other.
class Minimisation {
 public:
  Minimisation(const Networks<float>& networks, JointObjective<float>* objective, const Pca& pca,
               const TrainingOptions& training, const TrainingCallback& callback)
      : networks_(networks),
        objective_(*objective),
        squared_scale_(squaredScale(pca)),
        training_(training),
        schedule_(makeSchedule(training)),
        callback_(callback) {}

  /// Initial parameters, the auto-encoder's from PCA if this is one of the first starts and the
  /// schedule says so.
  Eigen::VectorXd initial(int start, const Networks<double>& networks,
                          const Eigen::MatrixXd& scores, std::mt19937_64* rng) const {
    return initialTheta(networks, scores, training_,
                        schedule_.pca_start && start < training_.pca_starts, rng);
  }

  /// @return w times the sum of the terms that the schedule minimises
  double cost(const Eigen::VectorXd& theta) {
    const Terms terms = schedule_.terms();
    return objective_.weight() * objective_.evaluate(theta.cast<float>(), nullptr, terms).of(terms);
  }

  /// @return what starts are chosen by: the error of predictions training/selection_steps ahead, or
  ///         the cost
  double selectionError(const Eigen::VectorXd& theta) {
    if (training_.selection_steps == 0) return cost(theta);
    Terms terms;
    terms.prediction_steps = training_.selection_steps;
    return objective_.weight() * objective_.evaluate(theta.cast<float>(), nullptr, terms).v_p;
  }

  /// @param done    of the whole training, when this start began
  /// @param theta   in: initial parameters, out: the minimum
  /// @param result  out: message; iterations and evaluations are added
  /// @return false if there is no usable minimum; the message tells why
  bool run(double done, Eigen::VectorXd* theta, TrainingResult* result) {
    const double share = 1.0 / static_cast<double>(schedule_.stages.size() * training_.num_starts);
    TrainingProgress before;
    before.fraction_done = done;
    for (const Stage& stage : schedule_.stages) {
      before.iteration = result->iterations;
      if (!runStage(stage, before, share / iterations(stage), theta, result)) return false;
      before.fraction_done += share;
    }
    return true;
  }

 private:
  int iterations(const Stage& stage) const {
    return stage.warm_up ? training_.warm_up_iterations : training_.max_iterations;
  }

  bool runStage(const Stage& stage, const TrainingProgress& before, double share,
                Eigen::VectorXd* theta, TrainingResult* result) {
    const Range free = freeParameters(networks_, stage.free);
    StageObjective function(&objective_, stage.terms, free, *theta);
    MinimiseOptions options;
    options.lbfgs_rank = training_.solver == "bfgs" ? 0 : training_.lbfgs_rank;
    options.max_iterations = iterations(stage);
    options.function_tolerance = training_.function_tolerance;
    options.gradient_tolerance = 1e-9;
    if (callback_) {
      options.on_iteration = [&](const Minimum& so_far) {
        TrainingProgress progress = before;
        progress.iteration += so_far.iterations;
        progress.v_r = squared_scale_ * function.best().v_r;
        progress.v_p = squared_scale_ * function.best().v_p;
        progress.gradient_norm = so_far.gradient.lpNorm<Eigen::Infinity>();
        progress.fraction_done += share * so_far.iterations;
        return callback_(progress);
      };
    }
    const Minimum minimum =
        minimise(std::ref(function), theta->segment(free.begin, free.size), options);
    theta->segment(free.begin, free.size) = minimum.x;
    result->message = minimum.message;
    result->iterations += minimum.iterations;
    result->evaluations += minimum.evaluations;
    if (minimum.reason == MinimumReason::kStopped) {
      result->message = "training was cancelled";
      result->cancelled = true;
      return false;
    }
    if (minimum.improved()) return true;
    result->message = "training did not lower the objective: " + minimum.message;
    return false;
  }

  const Networks<float>& networks_;
  JointObjective<float>& objective_;
  double squared_scale_;
  const TrainingOptions& training_;
  Schedule schedule_;
  const TrainingCallback& callback_;
};

}  // namespace

std::mt19937_64 initialisationStream(std::uint64_t seed, std::uint32_t trial) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         trial, 0U, kInitialisationRole};
  return std::mt19937_64(sequence);
}

TrainingResult train(const DataSet& data, const ModelOptions& model,
                     const TrainingOptions& training, ModelInfo info,
                     const TrainingCallback& callback) {
  const auto start = std::chrono::steady_clock::now();
  const Networks<float> networks(model, data.torqueDim());
  const Pca pca = fitPca(data, model.pca_dim, training.score_std);
  TrainingData<float> training_data = makeTrainingData(data, pca);
  const Eigen::MatrixXd scores = training_data.scores.cast<double>();
  const Networks<double> initial_networks(model, data.torqueDim());
  std::mt19937_64 rng = initialisationStream(info.seed, info.trial);
  JointObjective<float> objective(networks, std::move(training_data));
  Minimisation minimisation(networks, &objective, pca, training, callback);

  TrainingResult result;
  Eigen::VectorXd best;  // theta
  double best_error = std::numeric_limits<double>::infinity();
  std::string message;
  for (int number = 0; number < training.num_starts && !result.cancelled; ++number) {
    Eigen::VectorXd theta = minimisation.initial(number, initial_networks, scores, &rng);
    const double initial_cost = minimisation.cost(theta);
    const double done = static_cast<double>(number) / training.num_starts;
    if (!minimisation.run(done, &theta, &result)) continue;
    double error = minimisation.selectionError(theta);
    if (!std::isfinite(error))
      error = std::numeric_limits<double>::max();  // a roll-out without bound
    if (error >= best_error) continue;
    best_error = error;
    best = std::move(theta);
    message = result.message;
    result.initial_cost = initial_cost;
  }
  if (best.size() > 0 && !result.cancelled) {
    result.message = message;
    result.final_cost = minimisation.cost(best);
    const JointObjective<float>::Value value = objective.evaluate(best.cast<float>(), nullptr);
    info.frames = static_cast<std::uint32_t>(data.numFrames());
    info.v_r = squaredScale(pca) * value.v_r;
    info.v_p = squaredScale(pca) * value.v_p;
    info.feature_spread = objective.featureSpread();
    result.model.emplace(model, data.imageSize(), data.torqueDim(), pca, best, data.goal(), info);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ddm
