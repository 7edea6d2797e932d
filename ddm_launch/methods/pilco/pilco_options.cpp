// Parameters of PILCO in an experiment: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco_options.h"

#include <cmath>
#include <sstream>

namespace ddm {

std::vector<std::string> PilcoOptions::problems() const {
  std::vector<std::string> out;
  const auto require = [&out](bool ok, const std::string& rule, double value) {
    if (ok) return;
    std::ostringstream text;
    text << "pilco/" << rule << ", got " << value;
    out.push_back(text.str());
  };
  require(horizon >= 1 && horizon <= 100000, "horizon must lie in [1, 100000]", horizon);
  require(num_centres >= 1 && num_centres <= 1000, "num_centres must lie in [1, 1000]",
          num_centres);
  require(cost_width > 0.0 && std::isfinite(cost_width), "cost_width must be > 0", cost_width);
  require(start_std >= 0.0 && std::isfinite(start_std), "start_std must be >= 0", start_std);
  require(rate_noise >= 0.0 && std::isfinite(rate_noise), "rate_noise must be >= 0", rate_noise);
  require(angle_noise >= 0.0 && std::isfinite(angle_noise), "angle_noise must be >= 0",
          angle_noise);
  return out;
}

}  // namespace ddm
