// Parameters of the receding-horizon controller: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_options.h"

#include <ddm_model/per_motor.h>

#include <cmath>
#include <sstream>

namespace ddm {

std::vector<std::string> MpcOptions::problems() const {
  std::vector<std::string> out;
  const auto require = [&out](bool ok, const char* rule, const auto& value) {
    if (ok) return;
    std::ostringstream text;
    text << "mpc/" << rule << ", got " << value;
    out.push_back(text.str());
  };
  require(horizon >= 1 && horizon <= 1000, "horizon must lie in [1, 1000]", horizon);
  require(control_weight >= 0.0 && std::isfinite(control_weight), "control_weight must be >= 0",
          control_weight);
  require(offset_gain >= 0.0 && offset_gain <= 1.0, "offset_gain must be between 0 and 1",
          offset_gain);
  require(areLimits(max_torque), "max_torque must be > 0", limitsText(max_torque));
  require(epsilon >= 0.0 && epsilon <= 1.0, "epsilon must lie in [0, 1]", epsilon);
  require(hold_steps >= 1, "hold_steps must be >= 1", hold_steps);
  require(num_starts >= 1 && num_starts <= 1000, "num_starts must lie in [1, 1000]", num_starts);
  require(max_iterations >= 1, "max_iterations must be >= 1", max_iterations);
  require(function_tolerance >= 0.0 && function_tolerance < 1.0,
          "function_tolerance must lie in [0, 1)", function_tolerance);
  require(time_budget >= 0.0 && std::isfinite(time_budget), "time_budget must be >= 0",
          time_budget);
  return out;
}

}  // namespace ddm
