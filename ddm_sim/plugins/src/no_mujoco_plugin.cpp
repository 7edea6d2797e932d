// The plant `mujoco` where ddm_sim was built without MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>
#include <vector>

#include "mujoco_plugin.h"

namespace ddm {
namespace {

struct ModelOption {
  std::string model;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("model", model);
  }
  std::vector<std::string> problems() const { return {}; }
};

/// Names the model file that this build cannot simulate.
class NoMujocoPlugin : public PlantPlugin {
 public:
  std::string type() const override { return "mujoco"; }

  void read(ParamReader* reader) override {
    throw std::invalid_argument(
        "the plant of the model file \"" + reader->read<ModelOption>("plant").model +
        "\" (plant/type mujoco) needs MuJoCo and EGL, which ddm_sim was built without: install "
        "libmujoco-dev and libegl-dev, or see MuJoCo in doc/install.md where the system has no "
        "such packages, then configure and build the workspace again");
  }

  YAML::Node block() const override { return {}; }
  std::unique_ptr<Plant> make() const override { return nullptr; }
};

}  // namespace

std::shared_ptr<PlantPlugin> makeMujocoPlugin() { return std::make_shared<NoMujocoPlugin>(); }

}  // namespace ddm
