// What a plant says of itself, as YAML for people and scripts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ddm_sim/plant_info.h"

namespace ddm {

/// Keys joints (name, kind: angle or length), state, torque, max_torque, dt [s], start, start_std,
/// goal, error_unit, tolerance. Numbers are in the units that the names in `state` and `torque` end
/// with.
std::string describe(const PlantInfo& info);

}  // namespace ddm
