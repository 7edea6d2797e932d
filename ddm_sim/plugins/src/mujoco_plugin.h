// The plant `mujoco` as a configuration describes it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "ddm_plant_plugin/plant_plugin.h"

namespace ddm {

/// If ddm_sim was built without MuJoCo, its read() throws std::invalid_argument.
std::shared_ptr<PlantPlugin> makeMujocoPlugin();

}  // namespace ddm
