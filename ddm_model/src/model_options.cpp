// Parameters of the deep dynamical model and of its training: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/model_options.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "ddm_model/per_motor.h"
#include "ddm_model/schedule.h"

namespace ddm {
namespace {

template <class Value>
void require(bool ok, const std::string& rule, const Value& value, std::vector<std::string>* out) {
  if (ok) return;
  std::ostringstream text;
  text << rule << ", got " << value;
  out->push_back(text.str());
}

void requireWidths(const std::vector<int>& widths, const std::string& key,
                   std::vector<std::string>* out) {
  for (int width : widths) {
    require(width >= 1 && width <= 4096, key + " must lie in [1, 4096] each", width, out);
  }
}

}  // namespace

std::vector<std::string> ModelOptions::problems() const {
  std::vector<std::string> out;
  require(pca_dim >= 1 && pca_dim <= 1000, "model/pca_dim must lie in [1, 1000]", pca_dim, &out);
  require(feature_dim >= 1 && feature_dim <= 100, "model/feature_dim must lie in [1, 100]",
          feature_dim, &out);
  require(order >= 1 && order <= 50, "model/order must lie in [1, 50]", order, &out);
  requireWidths(encoder_widths, "model/encoder_widths", &out);
  requireWidths(decoder_widths, "model/decoder_widths", &out);
  requireWidths(predictor_widths, "model/predictor_widths", &out);
  require(areLimits(max_torque), "model/max_torque must be > 0", limitsText(max_torque), &out);
  return out;
}

std::vector<std::string> TrainingOptions::problems() const {
  std::vector<std::string> out;
  const std::vector<std::string> schedules = scheduleNames();
  std::string known;
  for (const std::string& name : schedules) known += (known.empty() ? "" : ", ") + name;
  require(std::find(schedules.begin(), schedules.end(), schedule) != schedules.end(),
          "training/schedule must be one of: " + known, schedule, &out);
  require(solver == "lbfgs" || solver == "bfgs", "training/solver must be lbfgs or bfgs", solver,
          &out);
  require(num_starts >= 1 && num_starts <= 1000, "training/num_starts must lie in [1, 1000]",
          num_starts, &out);
  require(selection_steps >= 0 && selection_steps <= 1000,
          "training/selection_steps must lie in [0, 1000]", selection_steps, &out);
  require(pca_starts >= 0 && pca_starts <= 1000, "training/pca_starts must lie in [0, 1000]",
          pca_starts, &out);
  require(prediction_steps >= 1 && prediction_steps <= 100,
          "training/prediction_steps must lie in [1, 100]", prediction_steps, &out);
  require(warm_up_iterations >= 0, "training/warm_up_iterations must be >= 0", warm_up_iterations,
          &out);
  require(weight_decay >= 0.0 && std::isfinite(weight_decay), "training/weight_decay must be >= 0",
          weight_decay, &out);
  require(selection_steps <= 0 || num_starts > 1,
          "training/selection_steps must be 0 where training/num_starts is 1: there is no choice",
          selection_steps, &out);
  if (schedule == "v_r_only") {
    require(selection_steps == 0 && prediction_steps == 1,
            "training/selection_steps must be 0 and prediction_steps 1 where nothing is predicted: "
            "training/schedule",
            schedule, &out);
  }
  require(max_iterations >= 1, "training/max_iterations must be >= 1", max_iterations, &out);
  require(function_tolerance >= 0.0 && function_tolerance < 1.0,
          "training/function_tolerance must lie in [0, 1)", function_tolerance, &out);
  require(lbfgs_rank >= 1 && lbfgs_rank <= 1000, "training/lbfgs_rank must lie in [1, 1000]",
          lbfgs_rank, &out);
  require(score_std > 0.0 && std::isfinite(score_std), "training/score_std must be > 0", score_std,
          &out);
  require(layer_std > 0.0 && std::isfinite(layer_std), "training/layer_std must be > 0", layer_std,
          &out);
  require(predictor_gain >= 0.0 && std::isfinite(predictor_gain),
          "training/predictor_gain must be >= 0", predictor_gain, &out);
  return out;
}

}  // namespace ddm
