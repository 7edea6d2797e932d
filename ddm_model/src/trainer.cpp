// Training of the deep dynamical model (paper, Sec. 2.3): PCA, initial weights, minimisation.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <ddm_common/random_stream.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>

#include "ddm_model/history.h"
#include "ddm_model/networks.h"
#include "ddm_model/pca.h"
#include "gp_fit.h"
#include "restart.h"

namespace ddm {
namespace {

constexpr Eigen::Index kMaxSupportStates = 1000;

/// Adds the statistics of the best restart to the origin of a model.
ModelInfo infoOf(const Restart& best, Problem* problem, const DataSet& data, double squared_scale,
                 ModelInfo info) {
  const auto value = problem->objective.evaluate(best.theta.cast<float>(), nullptr);
  info.frames = static_cast<std::uint32_t>(data.numFrames());
  info.v_r = squared_scale * value.v_r;
  info.v_p = squared_scale * value.v_p;
  info.feature_spread = problem->objective.featureSpread();
  return info;
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
  const Pca pca = fitPca(data, model.pca_dim, Blur(data.imageSize(), model.blur), check);
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

  // Keeps the best restart, which continues alone.
  Restart& best =
      *std::min_element(restarts.begin(), restarts.end(),
                        [](const Restart& a, const Restart& b) { return a.error < b.error; });
  TrainingResult result;
  if (std::isfinite(best.error)) finish(restart_problem, &progress, &best);
  for (const Restart& restart : restarts) {
    result.iterations += restart.iterations;
    result.evaluations += restart.evaluations;
  }
  if (std::isfinite(best.error)) {
    ModelOptions trained_model = model;
    Problem problem(model, scores);
    const double final_cost = problem.cost(best.theta, schedule.terms());
    ModelInfo trained = infoOf(best, &problem, data, squared_scale, info);
    if (std::isfinite(trained.v_r + trained.v_p)) {
      const Eigen::MatrixXf Z = problem.objective.features();
      if (model.predictor == "gp") {
        std::mt19937_64 draw = randomStream({info.seed, info.trial}, StreamRole::kGpSamples);
        replaceByGp(
            Z.cast<double>(), data, &draw, [&progress] { progress.repeat(); }, &trained_model,
            &best.theta);
      }
      trained.support_states = supportStates(Z, data, trained_model.order, kMaxSupportStates);
      result.initial_cost = best.initial_cost;
      result.final_cost = final_cost;
      result.model.emplace(trained_model, data.imageSize(), data.torqueDim(), pca, best.theta,
                           data.goal(), trained);
    } else {
      std::ostringstream text;
      text << "the errors of the model must be finite, got V_R " << trained.v_r << " and V_P "
           << trained.v_p << ": check the bags, or leave the block training at its defaults";
      best.message = text.str();
    }
  }
  result.message = best.message;
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
