// The plant `mujoco` where ddm_sim was built without MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "mujoco_plugin.h"

namespace ddm {

std::shared_ptr<PlantPlugin> makeMujocoPlugin() {
  throw std::invalid_argument(
      "plant/type mujoco needs MuJoCo and EGL, which ddm_sim was built without: install "
      "libmujoco-dev and libegl-dev, then configure and build the workspace again");
}

}  // namespace ddm
