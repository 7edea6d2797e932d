// Parameters of the deep dynamical model and of its training: checks of their values.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/model_options.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>

#include "ddm_model/per_motor.h"
#include "ddm_model/schedule.h"

namespace ddm {

std::vector<std::string> ModelOptions::problems() const {
  OptionChecks model("model");
  const auto requireWidths = [&model](const std::string& key, const std::vector<int>& widths) {
    for (const int width : widths) model.requireWithin(key, width, 1, 4096);
  };
  model.requireWithin("blur", blur, 0.0, 100.0);
  model.requireWithin("pca_dim", pca_dim, 1, 1000);
  model.requireWithin("feature_dim", feature_dim, 1, 100);
  model.requireWithin("order", order, 1, 50);
  requireWidths("encoder_widths", encoder_widths);
  model.require(predictor == "network" || predictor == "gp", "predictor", "be network or gp",
                predictor);
  requireWidths("predictor_widths", predictor_widths);
  model.require(areLimits(max_torque), "max_torque", "be > 0 and finite", limitsText(max_torque));
  return model.problems();
}

std::vector<std::string> TrainingOptions::problems() const {
  OptionChecks training("training");
  const std::vector<std::string> schedules = scheduleNames();
  training.require(std::find(schedules.begin(), schedules.end(), schedule) != schedules.end(),
                   "schedule", "be one of: " + boost::algorithm::join(schedules, ", "), schedule);
  training.require(solver == "lbfgs" || solver == "kfac" || solver == "bfgs", "solver",
                   "be lbfgs, kfac or bfgs", solver);
  training.requireWithin("num_starts", num_starts, 1, 1000);
  training.requireWithin("prediction_steps", prediction_steps, 1, 100);
  training.requireNotNegative("weight_decay", weight_decay);
  training.requireWithin("max_iterations", max_iterations, 1, 1000000);
  training.requireFraction("function_tolerance", function_tolerance);
  return training.problems();
}

}  // namespace ddm
