// Plugin of the plant type `mujoco`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "ddm_plant_plugin/plant_plugin.h"

namespace ddm {

/// Makes the plugin of MuJoCo plants.
/// @throws std::invalid_argument if ddm_sim was built without MuJoCo
std::shared_ptr<PlantPlugin> makeMujocoPlugin();

}  // namespace ddm
