// Training of the deep dynamical model (paper, Sec. 2.3): PCA, initial weights, minimisation.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <ddm_common/random_stream.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "ddm_model/history.h"
#include "ddm_model/networks.h"
#include "ddm_model/pca.h"
#include "gp_fit.h"
#include "restart.h"

namespace ddm {
namespace {

constexpr Eigen::Index kMaxSupportStates = 1000;

/// @return root mean squared distance of the columns of Z to their mean
double spreadOf(const Eigen::MatrixXd& Z) {
  const Eigen::MatrixXd centred = Z.colwise() - Z.rowwise().mean();
  return std::sqrt(centred.squaredNorm() / static_cast<double>(Z.cols()));
}

/// Auto-encoders of the kept restarts, joined, and the features of all images.
struct Joined {
  std::vector<Eigen::VectorXd> thetas;  // of each restart; empty: no restart has finite errors
  Eigen::MatrixXd Z;                    // [feature_dim of all x M]
  double v_r = 0.0, v_p = 0.0;          // of the best restart [score^2]
};

Joined join(const std::vector<Restart>& kept, const Terms& terms, Problem* problem) {
  Joined joined;
  for (const Restart& restart : kept) {
    const auto value = problem->objective.evaluate(restart.theta.cast<float>(), nullptr, terms);
    if (!std::isfinite(value.v_r + value.v_p)) continue;
    if (joined.thetas.empty()) {
      joined.v_r = value.v_r;
      joined.v_p = value.v_p;
    }
    const Eigen::MatrixXd Z = problem->objective.features().cast<double>();
    joined.Z.conservativeResize(joined.Z.rows() + Z.rows(), Z.cols());
    joined.Z.bottomRows(Z.rows()) = Z;
    joined.thetas.push_back(restart.theta);
  }
  return joined;
}

/// Implements train(). @throws Cancelled if the callback cancels the training
TrainingResult trainUnlessCancelled(const DataSet& data, const ModelOptions& model,
                                    const TrainingOptions& training, const ModelInfo& info,
                                    const TrainingCallback& callback) {
  const Networks<double> networks(model, data.torqueDim());  // eqs. (2), (3a), (3b)

  // Sec. 4: the encoder sees the leading principal components of all images and the goal image.
  const auto check = [&] {
    if (callback && !callback(TrainingProgress())) throw Cancelled();
  };
  const Pca pca = fitPca(data, model.pca_dim, Blur(data.imageSize(), model.blur),
                         model.normalise_brightness, check);
  const TrainingData<float> scores = makeTrainingData(data, pca);
  const double squared_scale = 1.0 / (static_cast<double>(pca.scale) * pca.scale);

  // Sec. 2.3, "Initialization": layer-wise PCA initialises the auto-encoder. Deviation: there are
  // several restarts, in which f has other random weights. The paper has a single training.
  const RestartProblem restart_problem(model, training, scores);
  const Schedule& schedule = restart_problem.schedule;
  std::mt19937_64 rng = randomStream({info.seed, info.trial}, StreamRole::kInitialisation);
  std::vector<Restart> restarts;
  for (int i = 0; i < training.num_starts; ++i) {
    restarts.push_back(
        {initialTheta(networks, scores.scores.cast<double>(), schedule.pca_start, &rng)});
  }

  // Eq. (5a): minimises V_R + V_P of eqs. (5b, 5c), or the terms of the schedule.
  Progress progress(callback, restart_problem.maxIterations(), squared_scale);
  minimiseRestarts(restart_problem, &progress, &restarts);

  // The best restarts continue on all samples.
  std::stable_sort(restarts.begin(), restarts.end(),
                   [](const Restart& a, const Restart& b) { return a.error < b.error; });
  std::vector<Restart> kept;
  TrainingResult result;
  for (Restart& restart : restarts) {
    if (std::isfinite(restart.error) && kept.size() < restart_problem.numKept()) {
      finish(restart_problem, &progress, &restart);
      kept.push_back(restart);
    }
    result.iterations += restart.iterations;
    result.evaluations += restart.evaluations;
  }
  result.message = restarts.front().message;
  if (kept.empty()) return result;

  Problem problem(model, scores);
  const Joined joined = join(kept, schedule.terms(), &problem);
  if (joined.thetas.empty()) {
    result.message =
        "the errors V_R and V_P of the model are not finite: check the bags, or leave the "
        "block training at its defaults";
    return result;
  }
  ModelOptions trained_model = model;
  Eigen::VectorXd theta = joined.thetas.front();
  if (model.predictor == "gp") {
    trained_model = joinedOptions(model, static_cast<int>(joined.thetas.size()));
    std::mt19937_64 draw = randomStream({info.seed, info.trial}, StreamRole::kGpSamples);
    theta = replaceByGp(trained_model, joinAutoEncoders(model, joined.thetas), joined.Z, data,
                        &draw, [&progress] { progress.repeat(); });
  }
  ModelInfo trained = info;
  trained.frames = static_cast<std::uint32_t>(data.numFrames());
  trained.v_r = squared_scale * joined.v_r;
  trained.v_p = squared_scale * joined.v_p;
  trained.feature_spread = spreadOf(joined.Z);
  trained.support_states =
      supportStates(joined.Z.cast<float>(), data, trained_model.order, kMaxSupportStates);
  result.model.emplace(trained_model, data.imageSize(), data.torqueDim(), pca, theta, data.goal(),
                       trained);
  return result;
}

}  // namespace

TrainingResult train(const DataSet& data, const ModelOptions& model,
                     const TrainingOptions& training, const ModelInfo& info,
                     const TrainingCallback& callback) {
  const auto began = std::chrono::steady_clock::now();
  TrainingResult result;
  try {
    result = trainUnlessCancelled(data, model, training, info, callback);
  } catch (const Cancelled&) {
    result.cancelled = true;
    result.message = "training was cancelled";
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return result;
}

}  // namespace ddm
