// Parameters of a robot: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "robot_options.h"

#include <cmath>
#include <sstream>

namespace ddm {

std::vector<std::string> RobotOptions::problems() const {
  std::vector<std::string> out;
  const auto require = [&out](bool ok, const char* rule, double value) {
    if (ok) return;
    std::ostringstream text;
    text << "robot/" << rule << ", got " << value;
    out.push_back(text.str());
  };
  require(dt >= 0.001 && dt <= 10.0, "dt must lie in [0.001, 10]", dt);
  require(crop_x >= 0 && crop_x < 16384, "crop_x must lie in [0, 16383]", crop_x);
  require(crop_y >= 0 && crop_y < 16384, "crop_y must lie in [0, 16383]", crop_y);
  require(crop_width >= 0 && crop_width <= 16384, "crop_width must lie in [0, 16384]", crop_width);
  require(crop_height >= 0 && crop_height <= 16384, "crop_height must lie in [0, 16384]",
          crop_height);
  require(max_torque > 0.0 && std::isfinite(max_torque), "max_torque must be > 0", max_torque);
  require(slew_rate >= 0.0 && std::isfinite(slew_rate), "slew_rate must be >= 0", slew_rate);
  require(effort_rate >= 1.0 && effort_rate <= 1000.0, "effort_rate must lie in [1, 1000]",
          effort_rate);
  require(reset_timeout > 0.0 && std::isfinite(reset_timeout), "reset_timeout must be > 0",
          reset_timeout);
  return out;
}

}  // namespace ddm
