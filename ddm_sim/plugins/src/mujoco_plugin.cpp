// Plugin of the plant type `mujoco`.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_mujoco/mujoco_plant.h>
#include <ros/package.h>

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "ddm_plant_plugin/plant_plugin.h"

namespace ddm {
namespace {

/// Makes a path absolute, because nodes run in another folder than the user's, and an experiment
/// may be resumed from another folder.
std::string absolute(const std::string& path) {
  if (path.empty() || path.rfind("package://", 0) == 0) return path;
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// Reads the model file once, so that all plants use the same model even if the file changes.
class MujocoPlugin : public PlantPlugin {
 public:
  std::string type() const override { return "mujoco"; }

  void read(ParamReader* reader) override {
    options_ = reader->read<MujocoOptions>("plant");
    if (!options_.problems().empty()) return;  // the reader collects the problems
    options_.model = absolute(options_.model);
    model_ = std::make_shared<MujocoModel>(
        options_.model, [](const std::string& package) { return ros::package::getPath(package); });
    options_ = completed(options_, *model_);
    requireVisible(model_, options_);
  }

  YAML::Node block() const override { return toYaml(options_); }

  std::unique_ptr<Plant> make() const override {
    return std::make_unique<MujocoPlant>(model_, options_);
  }

  std::string renderer() const override {
    try {
      return openGlRenderer();
    } catch (const std::runtime_error& e) {
      return std::string("none: ") + e.what();
    }
  }

 private:
  MujocoOptions options_;
  std::shared_ptr<const MujocoModel> model_;
};

}  // namespace

/// Declared and called in plant_config.cpp.
std::shared_ptr<PlantPlugin> makeMujocoPlugin() { return std::make_shared<MujocoPlugin>(); }

}  // namespace ddm
