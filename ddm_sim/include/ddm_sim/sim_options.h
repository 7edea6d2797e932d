// How simulated time passes. YAML block `sim:`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_sim/option_checks.h"

namespace ddm {

/// Parameters of sim_node.
struct SimOptions {
  bool lockstep = true;   ///< true: an image waits for its torque; false: real time
  double watchdog = 5.0;  ///< lock-step: wall time that a torque may take [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("lockstep", lockstep);
    visitor("watchdog", watchdog);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
    OptionChecks sim("sim");
    sim.require(watchdog >= 0.1 && watchdog <= 86400.0, "watchdog", "lie in [0.1, 86400] s",
                watchdog);
    return sim.problems();
  }
};

}  // namespace ddm
