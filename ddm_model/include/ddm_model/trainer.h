// Training: PCA, initial weights, then the stages of a schedule, minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"
#include "ddm_model/model_options.h"

namespace ddm {

/// Progress of a training, at the best parameters of the current stage so far.
struct TrainingProgress {
  int iteration = 0;
  double v_r = 0.0;  ///< [grey^2]
  double v_p = 0.0;  ///< [grey^2]
  /// Largest entry of the gradient of the scaled objective. With training/solver kfac, it refers to
  /// preconditioned coordinates, which change every 50 iterations; compare it only in between.
  double gradient_norm = 0.0;
  double fraction_done = 0.0;  ///< iterations / their cap, over all restarts and stages [-]
};

/// Receives the progress: zeros while the principal components are computed, then numbers after
/// each iteration of any restart. Calls come from several threads, but never two at a time.
/// Returning false cancels the training.
using TrainingCallback = std::function<bool(const TrainingProgress&)>;

/// Result of a training. Numerical trouble is reported in `message`, never thrown.
struct TrainingResult {
  std::optional<Ddm> model;  ///< empty if the training failed or was cancelled
  bool cancelled = false;    ///< the callback cancelled the training
  std::string message;       ///< why there is no model, or why the solver ended
  int iterations = 0;
  int evaluations = 0;   ///< evaluations of the objective with its gradient
  double seconds = 0.0;  ///< wall time [s]
};

/// Trains a model on all data from new initial weights (a warm start from the last optimum gets
/// stuck), by the stages of training/schedule (paper, Sec. 2.3). Of several restarts, the one with
/// the smallest objective on about half of the data continues on all data. With model/predictor gp,
/// the better half of the restarts continues: their features are joined, so that the model has
/// several times model/feature_dim features.
/// @param data   all samples so far
/// @param model  architecture
/// @param info   seed, trial and config are kept; the training fills in the other fields
/// @throws std::invalid_argument if there are too few data for the options, or all images are equal
TrainingResult train(const DataSet& data, const ModelOptions& model,
                     const TrainingOptions& training, const ModelInfo& info,
                     const TrainingCallback& callback = nullptr);

}  // namespace ddm
