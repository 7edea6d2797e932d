// How simulated time passes. YAML blocks `sim:` and `show:`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <string>
#include <vector>

namespace ddm {

/// Block `sim`.
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
    sim.requireWithin("watchdog", watchdog, 0.1, 86400.0);
    return sim.problems();
  }
};

/// Block `show`: what changes nothing of what happens.
struct ShowOptions {
  double frame_rate = 0.0;  ///< lock-step: most frames in a second of wall time; 0: any [1/s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("frame_rate", frame_rate);
  }
  std::vector<std::string> problems() const {
    OptionChecks show("show");
    if (frame_rate != 0.0) show.requireWithin("frame_rate", frame_rate, 1.0, 1e6);
    return show.problems();
  }
};

}  // namespace ddm
