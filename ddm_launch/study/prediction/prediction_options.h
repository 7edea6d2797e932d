// Parameters of prediction_experiment.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <string>
#include <vector>

namespace ddm {

/// Block `prediction`: what prediction_experiment does.
struct PredictionOptions {
  int training_frames = 501;  ///< frames to learn from [-]
  int held_out_frames = 100;  ///< frames after them to predict [-]
  int max_steps = 8;          ///< longest prediction, steps [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("training_frames", training_frames);
    visitor("held_out_frames", held_out_frames);
    visitor("max_steps", max_steps);
  }

  std::vector<std::string> problems() const {
    OptionChecks checks("prediction");
    checks.requireWithin("training_frames", training_frames, 1, 1000000);
    checks.requireWithin("max_steps", max_steps, 1, 1000);
    checks.requireWithin("held_out_frames", held_out_frames, 1, 1000000);
    return checks.problems();
  }
};

}  // namespace ddm
