// Training: PCA, initial parameters, then V_R + V_P minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <chrono>
#include <cmath>

#include "ddm_model/initialisation.h"
#include "ddm_model/objective.h"
#include "ddm_model/pca.h"

namespace ddm {
namespace {

constexpr std::uint32_t kInitialisationRole = 2;

/// The scaled joint objective in float32 as Ceres wants it: a function of doubles.
class CeresObjective : public ceres::FirstOrderFunction {
 public:
  CeresObjective(JointObjective<float>* objective, Eigen::Index num_params)
      : objective_(objective), theta_(num_params), gradient_(num_params) {}

  bool Evaluate(const double* theta, double* cost, double* gradient) const override {
    theta_ = Eigen::Map<const Eigen::VectorXd>(theta, theta_.size()).cast<float>();
    last_ = objective_->evaluate(theta_, gradient != nullptr ? &gradient_ : nullptr);
    ++evaluations_;
    const double weight = objective_->weight();
    *cost = weight * (last_.v_r + last_.v_p);
    if (gradient != nullptr) {
      Eigen::Map<Eigen::VectorXd>(gradient, gradient_.size()) = weight * gradient_.cast<double>();
    }
    return std::isfinite(*cost) && (gradient == nullptr || gradient_.allFinite());
  }
  int NumParameters() const override { return static_cast<int>(theta_.size()); }

  JointObjective<float>::Value last() const { return last_; }
  int evaluations() const { return evaluations_; }

 private:
  JointObjective<float>* objective_;
  mutable Eigen::VectorXf theta_;
  mutable Eigen::VectorXf gradient_;
  mutable JointObjective<float>::Value last_;
  mutable int evaluations_ = 0;
};

/// Tells progress and passes on the wish to stop.
class ProgressCallback : public ceres::IterationCallback {
 public:
  ProgressCallback(const CeresObjective* objective, double grey_per_score, int max_iterations,
                   const TrainingCallback& callback)
      : objective_(objective),
        squared_scale_(grey_per_score * grey_per_score),
        max_iterations_(max_iterations),
        callback_(callback) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (!callback_) return ceres::SOLVER_CONTINUE;
    TrainingProgress progress;
    progress.iteration = summary.iteration;
    progress.v_r = squared_scale_ * objective_->last().v_r;
    progress.v_p = squared_scale_ * objective_->last().v_p;
    progress.gradient_norm = summary.gradient_max_norm;
    progress.fraction_done = static_cast<double>(summary.iteration) / max_iterations_;
    return callback_(progress) ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }

 private:
  const CeresObjective* objective_;
  double squared_scale_;
  int max_iterations_;
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

TrainingData<float> trainingData(const DataSet& data, const Pca& pca, double max_torque) {
  TrainingData<float> out;
  const Eigen::Index n = data.numFrames();
  out.scores.resize(pca.basis.cols(), n + (data.hasGoal() ? 1 : 0));
  out.scores.leftCols(n) = pca.project(data.pixels());
  if (data.hasGoal()) {
    out.scores.col(n) =
        pca.project(Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>>(
            data.goal().data(), data.numPixels(), 1));
  }
  out.torques = (data.torques() / max_torque).cast<float>();
  out.pieces = data.pieces();
  return out;
}

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
  TrainingData<float> training_data = trainingData(data, pca, model.max_torque);
  std::mt19937_64 rng = initialisationStream(info.seed, info.trial);
  Eigen::VectorXd theta = initialTheta(Networks<double>(model, data.torqueDim()),
                                       training_data.scores.cast<double>(), training, &rng);
  JointObjective<float> objective(networks, std::move(training_data));

  auto* const function = new CeresObjective(&objective, theta.size());
  const ceres::GradientProblem problem(function);  // owns the function
  ProgressCallback progress(function, 1.0 / pca.scale, training.max_iterations, callback);
  ceres::GradientProblemSolver::Options options = solverOptions(training);
  options.callbacks.push_back(&progress);
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, theta.data(), &summary);

  TrainingResult result;
  result.message = summary.message;
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  const bool cancelled = summary.termination_type == ceres::USER_FAILURE;
  const bool improved = theta.allFinite() && summary.final_cost < summary.initial_cost;
  if (!cancelled && improved) {
    const JointObjective<float>::Value value = objective.evaluate(theta.cast<float>(), nullptr);
    const double squared_scale = 1.0 / (static_cast<double>(pca.scale) * pca.scale);
    info.frames = static_cast<std::uint32_t>(data.numFrames());
    info.v_r = squared_scale * value.v_r;
    info.v_p = squared_scale * value.v_p;
    result.model.emplace(model, data.imageSize(), data.torqueDim(), std::move(pca),
                         std::move(theta), data.goal(), std::move(info));
  } else if (cancelled) {
    result.message = "training was cancelled";
  } else {
    result.message = "training did not lower the objective: " + summary.message;
  }
  result.evaluations = function->evaluations();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace ddm
