// Training: PCA, initial parameters, then the stages of a schedule minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "ddm_model/initialisation.h"
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

/// The scaled objective of one stage in float32 as Ceres wants it: a function of the free
/// parameters, in double.
class CeresObjective : public ceres::FirstOrderFunction {
 public:
  /// @param theta  all parameters; gives the values of those that are not free
  CeresObjective(JointObjective<float>* objective, Terms terms, Range free,
                 const Eigen::VectorXd& theta)
      : objective_(objective), terms_(terms), free_(free), theta_(theta.cast<float>()) {}

  bool Evaluate(const double* free, double* cost, double* gradient) const override {
    theta_.segment(free_.begin, free_.size) =
        Eigen::Map<const Eigen::VectorXd>(free, free_.size).cast<float>();
    last_ = objective_->evaluate(theta_, gradient != nullptr ? &gradient_ : nullptr, terms_);
    ++evaluations_;
    const double weight = objective_->weight();
    *cost = weight * last_.of(terms_);
    if (gradient != nullptr) {
      Eigen::Map<Eigen::VectorXd>(gradient, free_.size) =
          weight * gradient_.segment(free_.begin, free_.size).cast<double>();
    }
    return std::isfinite(*cost) && (gradient == nullptr || gradient_.allFinite());
  }
  int NumParameters() const override { return static_cast<int>(free_.size); }

  JointObjective<float>::Value last() const { return last_; }
  int evaluations() const { return evaluations_; }

 private:
  JointObjective<float>* objective_;
  Terms terms_;
  Range free_;
  mutable Eigen::VectorXf theta_;
  mutable Eigen::VectorXf gradient_;
  mutable JointObjective<float>::Value last_;
  mutable int evaluations_ = 0;
};

/// Tells progress and passes on the wish to stop.
class ProgressCallback : public ceres::IterationCallback {
 public:
  /// @param before  progress when the stage began
  /// @param share   of the whole training that one iteration of the stage is, at most
  ProgressCallback(const CeresObjective* objective, double squared_scale,
                   const TrainingProgress& before, double share, const TrainingCallback& callback)
      : objective_(objective),
        squared_scale_(squared_scale),
        before_(before),
        share_(share),
        callback_(callback) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (!callback_) return ceres::SOLVER_CONTINUE;
    TrainingProgress progress;
    progress.iteration = before_.iteration + summary.iteration;
    progress.v_r = squared_scale_ * objective_->last().v_r;
    progress.v_p = squared_scale_ * objective_->last().v_p;
    progress.gradient_norm = summary.gradient_max_norm;
    progress.fraction_done = before_.fraction_done + share_ * summary.iteration;
    return callback_(progress) ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }

 private:
  const CeresObjective* objective_;
  double squared_scale_;
  TrainingProgress before_;
  double share_;
  const TrainingCallback& callback_;
};

ceres::GradientProblemSolver::Options solverOptions(const TrainingOptions& training) {
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = training.solver == "bfgs" ? ceres::BFGS : ceres::LBFGS;
  options.max_lbfgs_rank = training.lbfgs_rank;
  options.max_num_iterations = training.max_iterations;
  options.function_tolerance = training.function_tolerance;
  options.gradient_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  return options;
}

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
    auto* const function = new CeresObjective(&objective_, stage.terms, free, *theta);
    const ceres::GradientProblem problem(function);  // owns the function
    ProgressCallback progress(function, squared_scale_, before, share, callback_);
    ceres::GradientProblemSolver::Options options = solverOptions(training_);
    options.max_num_iterations = iterations(stage);
    options.callbacks.push_back(&progress);
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, theta->data() + free.begin, &summary);

    result->message = summary.message;
    result->iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    result->evaluations += function->evaluations();
    if (summary.termination_type == ceres::USER_FAILURE) {
      result->message = "training was cancelled";
      result->cancelled = true;
      return false;
    }
    // The solver may call a start from which it cannot move a minimum.
    if (theta->allFinite() && summary.final_cost < summary.initial_cost) return true;
    result->message = "training did not lower the objective: " + summary.message;
    return false;
  }

  const Networks<float>& networks_;
  JointObjective<float>& objective_;
  double squared_scale_;
  const TrainingOptions& training_;
  Schedule schedule_;
  const TrainingCallback& callback_;
};

/// What starts are chosen by, where training/selection_steps asks for it: how well they predict
/// that many steps ahead; with training/held_out the end of each piece that is long enough, which
/// none of them has been trained to predict then, without it all frames.
class Selection {
 public:
  /// @param data  in: all, out: without the frames that predictions are measured on
  Selection(const Networks<float>& networks, TrainingData<float>* data, int order,
            const TrainingOptions& training)
      : objective_(networks, split(data, order, training)) {
    terms_.prediction_steps = training.selection_steps;
  }

  double error(const Eigen::VectorXd& theta) {
    return objective_.weight() * objective_.evaluate(theta.cast<float>(), nullptr, terms_).v_p;
  }

 private:
  static TrainingData<float> split(TrainingData<float>* data, int order,
                                   const TrainingOptions& training) {
    TrainingData<float> held_out = *data;
    if (training.held_out == 0.0) return held_out;
    held_out.pieces.clear();
    for (Piece& piece : data->pieces) {
      const auto size = static_cast<Eigen::Index>(
          std::lround(training.held_out * static_cast<double>(piece.size)));
      if (size <= order || piece.size - size <= order) continue;  // too short to be divided
      piece.size -= size;
      held_out.pieces.push_back({piece.begin + piece.size, size});
    }
    if (held_out.pieces.empty()) {
      throw std::invalid_argument(
          "training/held_out holds nothing out: a share of no piece of the data (frames without a "
          "gap) and what is left are both more than model/order = " +
          std::to_string(order) + " frames. Record longer trials or set it to 0");
    }
    return held_out;
  }

  JointObjective<float> objective_;
  Terms terms_;
};

/// What one start came to.
struct Candidate {
  Eigen::VectorXd theta;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double chosen_by = 0.0;  ///< less is better
  std::string message;     ///< how the solver ended
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
  Pca pca = fitPca(data, model.pca_dim, training.score_std);
  TrainingData<float> training_data = makeTrainingData(data, pca, model.max_torque);
  const Eigen::MatrixXd scores = training_data.scores.cast<double>();
  const Networks<double> initial_networks(model, data.torqueDim());
  std::mt19937_64 rng = initialisationStream(info.seed, info.trial);
  std::optional<Selection> selection;
  if (training.num_starts > 1 && training.selection_steps > 0) {
    selection.emplace(networks, &training_data, model.order, training);
  }
  JointObjective<float> objective(networks, std::move(training_data));
  Minimisation minimisation(networks, &objective, pca, training, callback);

  TrainingResult result;
  std::vector<Candidate> candidates;
  for (int number = 0; number < training.num_starts && !result.cancelled; ++number) {
    Candidate candidate;
    candidate.theta = minimisation.initial(number, initial_networks, scores, &rng);
    candidate.initial_cost = minimisation.cost(candidate.theta);
    const double done = static_cast<double>(number) / training.num_starts;
    if (!minimisation.run(done, &candidate.theta, &result)) continue;
    candidate.final_cost = minimisation.cost(candidate.theta);
    candidate.chosen_by = selection ? selection->error(candidate.theta) : candidate.final_cost;
    if (!std::isfinite(candidate.chosen_by)) {  // a roll-out that grows without bound
      candidate.chosen_by = std::numeric_limits<double>::infinity();
    }
    candidate.message = result.message;
    candidates.push_back(std::move(candidate));
  }
  if (!candidates.empty() && !result.cancelled) {
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.chosen_by < b.chosen_by; });
    const auto most = static_cast<size_t>(training.ensemble_size);
    if (candidates.size() > most) candidates.resize(most);
    result.message = candidates.front().message;
    result.initial_cost = candidates.front().initial_cost;
    result.final_cost = candidates.front().final_cost;
    info.frames = static_cast<std::uint32_t>(data.numFrames());
    std::vector<Ddm> models;
    for (const Candidate& candidate : candidates) {
      const JointObjective<float>::Value value =
          objective.evaluate(candidate.theta.cast<float>(), nullptr);
      info.v_r = squaredScale(pca) * value.v_r;
      info.v_p = squaredScale(pca) * value.v_p;
      info.feature_spread = objective.featureSpread();
      models.emplace_back(model, data.imageSize(), data.torqueDim(), pca, candidate.theta,
                          data.goal(), info);
    }
    result.model = std::move(models.front());
    models.erase(models.begin());
    result.model->setOthers(std::move(models));
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ddm
