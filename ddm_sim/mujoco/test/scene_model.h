// The scene that the renderer's tests draw.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/renderer.h"

namespace ddm {
namespace testing {

/// A model, and its data with the first joint at an angle [rad].
struct SceneModel {
  explicit SceneModel(double angle = 0.0) {
    data->qpos[0] = angle;
    mj_forward(&model->get(), data.get());
  }

  const std::shared_ptr<const MujocoModel> model = std::make_shared<MujocoModel>(
      DDM_MUJOCO_TEST_SCENE, [](const std::string& /*package*/) { return ""; });
  const std::shared_ptr<mjData> data{mj_makeData(&model->get()), mj_deleteData};
};

inline RenderOptions colourful(const std::string& camera = "front") {
  RenderOptions options;
  options.camera = camera;
  options.colour = true;
  return options;
}

}  // namespace testing
}  // namespace ddm
