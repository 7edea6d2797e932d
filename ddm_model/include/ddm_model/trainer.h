// Training: PCA, initial parameters, then the stages of a schedule minimised by (L-)BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"
#include "ddm_model/model_options.h"

namespace ddm {

/// State of a training under way: at the best parameters so far of the present stage.
struct TrainingProgress {
  int iteration = 0;
  double v_r = 0.0;  ///< [grey^2]
  double v_p = 0.0;  ///< [grey^2]
  /// Largest entry of the scaled objective's gradient; with training/solver kfac in preconditioned coordinates, which
  /// change every 50 iterations, so that values before and after a change do not compare.
  double gradient_norm = 0.0;
  double fraction_done = 0.0;  ///< iterations over their caps, of all restarts and stages
};

/// Called while the principal components are computed, with zeros, and after each iteration of any restart. The calls come
/// from any thread, but never from two at a time. Returning false ends the training without a model.
using TrainingCallback = std::function<bool(const TrainingProgress&)>;

/// What a training came to. Numerical trouble is reported here, never thrown.
struct TrainingResult {
  std::optional<Ddm> model;  ///< empty if the training failed or was cancelled
  bool cancelled = false;    ///< the callback ended it
  std::string message;       ///< why there is no model, or why the search ended
  int iterations = 0;
  int evaluations = 0;        ///< of the objective with its gradient
  double initial_cost = 0.0;  ///< scaled sum of the terms that the schedule minimises, before
  double final_cost = 0.0;    ///< and after, of the restart that is kept; 0 without a model
  double seconds = 0.0;       ///< wall time [s]
};

/// Trains a model from scratch on all data (a warm start from the last optimum gets stuck) by the
/// schedule of `training`, with num_starts restarts for each delay that is tried, and keeps the best.
/// Its model/delay is in the model's options. Delays for which no segment is long enough are not tried.
/// @param info  seed, trial and config are kept; frames, V_R, V_P and the spread are filled in
/// @throws std::invalid_argument if the data are too few for the options, or all the same
TrainingResult train(const DataSet& data, const ModelOptions& model,
                     const TrainingOptions& training, const ModelInfo& info,
                     const TrainingCallback& callback = nullptr);

}  // namespace ddm
