// Plugin of the plant type `mujoco` if ddm_sim was built without MuJoCo: reports an error.
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "mujoco_plugin.h"

namespace ddm {

std::shared_ptr<PlantPlugin> makeMujocoPlugin() {
  throw std::invalid_argument(
      "plant/type must be a plant that this build has, got mujoco, which needs MuJoCo and EGL: "
      "install libmujoco-dev and libegl-dev, or see MuJoCo in doc/install.md where the system has "
      "no such packages, then configure and build the workspace again");
}

}  // namespace ddm
