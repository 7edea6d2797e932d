// The plant `mujoco` where ddm_sim was built without MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "mujoco_plugin.h"

namespace ddm {

std::shared_ptr<PlantPlugin> makeMujocoPlugin() {
  throw std::invalid_argument(
      "plant/type mujoco needs MuJoCo, EGL and TinyXML-2, which ddm_sim was built without: install "
      "libmujoco-dev, libegl-dev and libtinyxml2-dev, then configure and build the workspace "
      "again");
}

}  // namespace ddm
