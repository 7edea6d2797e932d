// The kinds of reference values that pilco_check knows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "check/case.h"

namespace ddm {
namespace pilco {
namespace check {

/// Computes one case and compares all of its fields.
using Check = void (*)(Case* reference);

// gp_checks.cpp
void checkGpPredict(Case* reference);
void checkSparseGpPredict(Case* reference);
// training_checks.cpp
void checkLikelihood(Case* reference);
void checkTraining(Case* reference);
// moment_checks.cpp
void checkTrigonometric(Case* reference);
void checkSine(Case* reference);
void checkSquashing(Case* reference);
// policy_checks.cpp
void checkPolicy(Case* reference);
// cost_checks.cpp
void checkSaturatingCost(Case* reference);
void checkPendulumCost(Case* reference);
// simulate_check.cpp
void checkSimulation(Case* reference);
// prediction_checks.cpp
void checkPropagation(Case* reference);
void checkValue(Case* reference);
void checkAuthors(Case* reference);

/// By the names that the kinds have in a file.
inline const std::map<std::string, Check>& kinds() {
  static const std::map<std::string, Check> all = {{"gp_predict", checkGpPredict},
                                                   {"gp_predict_fitc", checkSparseGpPredict},
                                                   {"gp_nlml", checkLikelihood},
                                                   {"train", checkTraining},
                                                   {"gtrig", checkTrigonometric},
                                                   {"gsin", checkSine},
                                                   {"gsat", checkSquashing},
                                                   {"policy", checkPolicy},
                                                   {"loss_sat", checkSaturatingCost},
                                                   {"loss_pendulum", checkPendulumCost},
                                                   {"simulate", checkSimulation},
                                                   {"propagate", checkPropagation},
                                                   {"value", checkValue},
                                                   {"authors", checkAuthors}};
  return all;
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
