// The scene that the renderer's tests draw.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/renderer.h"

namespace ddm {
namespace testing {

/// A model, and its data with the first joint at an angle [rad].
struct SceneModel {
  explicit SceneModel(double angle = 0.0) {
    installMujocoHandlers();
    char problem[500] = "";
    model.reset(mj_loadXML(DDM_MUJOCO_TEST_SCENE, nullptr, problem, sizeof(problem)),
                mj_deleteModel);
    if (!model) throw std::runtime_error(problem);
    data.reset(mj_makeData(model.get()), mj_deleteData);
    turn(angle);
  }

  void turn(double angle) {
    data->qpos[0] = angle;
    mj_forward(model.get(), data.get());
  }

  std::shared_ptr<mjModel> model;
  std::shared_ptr<mjData> data;
};

inline RenderOptions colourful(const std::string& camera = "front") {
  RenderOptions options;
  options.camera = camera;
  options.colour = true;
  return options;
}

}  // namespace testing
}  // namespace ddm
