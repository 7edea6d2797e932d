// What the two published versions of the pendulum scenario have fixed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/case.h"

namespace ddm {
namespace pilco {
namespace check {

struct Scenario {
  double gravity;           ///< [m / s^2]
  double friction;          ///< [N m s / rad]
  double time_step;         ///< [s]
  bool noisy_policy_input;  ///< see PropagationOptions
};

/// That of the field `scenario`.
/// @throws CaseError for another name than a0b48b7 and f9707a9
inline Scenario readScenario(Case* reference) {
  const std::string name = reference->text("scenario");
  if (name == "a0b48b7") return {9.82, 0.01, 0.1, false};
  if (name != "f9707a9") reference->fail("scenario", "must be a0b48b7 or f9707a9, got " + name);
  return {0.0, 1.0, 0.2, true};
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
