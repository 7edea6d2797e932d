// Reads the block `plant` of a configuration, and finds the file that describes a plant.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_plant_plugin/plant_config.h"

#include <ddm_sim/moving_tile.h>
#include <ddm_sim/pendulum.h>
#include <ddm_sim/two_link.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <stdexcept>
#include <vector>

namespace ddm {

#ifdef DDM_HAS_MUJOCO
std::shared_ptr<PlantPlugin> makeMujocoPlugin();  // in mujoco_plugin.cpp
#else
std::shared_ptr<PlantPlugin> makeMujocoPlugin() {
  throw std::invalid_argument(
      "plant/type must be a plant that this build has, got mujoco, which needs MuJoCo and EGL: "
      "install libmujoco-dev and libegl-dev, or see MuJoCo in doc/install.md where the system has "
      "no such packages, then configure and build the workspace again");
}
#endif

namespace {

namespace fs = std::filesystem;

using boost::algorithm::join;

using MakePlugin = std::function<std::shared_ptr<PlantPlugin>()>;

/// The plant types of this package.
const std::map<std::string, MakePlugin>& ownPlants() {
  static const std::map<std::string, MakePlugin> plants = {
      {"moving_tile", std::make_shared<PlantPluginOf<MovingTile, MovingTileOptions>>},
      {"mujoco", makeMujocoPlugin},
      {"pendulum", std::make_shared<PlantPluginOf<Pendulum, PendulumOptions>>},
      {"two_link", std::make_shared<PlantPluginOf<TwoLink, TwoLinkOptions>>}};
  return plants;
}

std::shared_ptr<PlantPlugin> makePlugin(const std::string& type) {
  const auto own = ownPlants().find(type);
  if (own != ownPlants().end()) return own->second();
  std::vector<std::string> known;
  for (const auto& plant : ownPlants()) known.push_back(plant.first);
  if (type.find('/') == std::string::npos) {
    throw std::invalid_argument(
        "plant/type must be a plant of ddm_sim or PACKAGE/CLASS of another package, got \"" + type +
        "\": there are " + join(known, ", "));
  }
  // Never destroyed, because loaded plants and their code must exist until the program ends.
  static auto* const loader =
      new pluginlib::ClassLoader<PlantPlugin>("ddm_sim", "ddm::PlantPlugin");
  if (!loader->isClassAvailable(type)) {
    const std::vector<std::string> others = loader->getDeclaredClasses();
    known.insert(known.end(), others.begin(), others.end());
    throw std::invalid_argument("plant/type must be a plant of this workspace, got \"" + type +
                                "\": there are " + join(known, ", ") +
                                "; source the setup.bash of the workspace that holds it");
  }
  try {
    return loader->createUniqueInstance(type);
  } catch (const pluginlib::PluginlibException& e) {
    throw std::runtime_error("the plugin " + type + " of plant/type cannot be loaded: " + e.what());
  }
}

}  // namespace

std::shared_ptr<const PlantPlugin> readPlant(ParamReader* reader) {
  // a copy, because the type determines which keys of the block are known and valid
  ParamReader ahead = *reader;
  const std::string type = ahead.read<PlantOptions>("plant").type;
  const std::shared_ptr<PlantPlugin> plugin = makePlugin(type.empty() ? "pendulum" : type);
  plugin->read(reader);
  return plugin;
}

std::shared_ptr<const PlantPlugin> readPlantFiles(std::vector<std::string> files) {
  files.insert(files.begin(), ros::package::getPath("ddm_sim") + "/config/sim.yaml");
  ParamReader params = ParamReader::fromFiles(files);
  const auto plant = readPlant(&params);
  params.requireValid();
  return plant;
}

std::vector<std::string> plantsOf(const std::string& package) {
  const std::string path = ros::package::getPath(package);
  if (path.empty()) {
    throw std::invalid_argument("package " + package +
                                " cannot be found: source the setup.bash of its workspace");
  }
  std::vector<std::string> names;
  const fs::path folder = fs::path(path) / "config";
  if (!fs::is_directory(folder)) return names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    const bool of_a_plant = name.stem() != "sim" && name.stem() != "robot";
    if (name.extension() == ".yaml" && of_a_plant) names.push_back(name.stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool namesPlantFile(const std::string& name) { return fs::path(name).extension() == ".yaml"; }

std::string plantFile(const std::string& name) {
  if (namesPlantFile(name)) {
    if (fs::is_regular_file(name)) return name;
    throw std::invalid_argument("unknown plant '" + name +
                                "': there is no such file; correct its name, or make the file by "
                                "`rosrun ddm_sim new_plant MODEL --out " +
                                name + "`");
  }
  const std::string ending = fs::path(name).extension().string();
  if (ending == ".urdf" || ending == ".xml") {
    throw std::invalid_argument("unknown plant '" + name +
                                "': a plant is a file that ends in .yaml; make one of this model "
                                "by `rosrun ddm_sim new_plant " +
                                name + " --out FILE.yaml`");
  }
  const std::string::size_type slash = name.find('/');
  const bool ours = slash == std::string::npos;
  const std::string package = ours ? "ddm_sim" : name.substr(0, slash);
  const std::string plant = ours ? name : name.substr(slash + 1);
  std::string problem = "unknown plant '" + name + "': there are " +
                        join(plantsOf("ddm_sim"), ", ") + "; or a file that ends in .yaml";
  try {
    const std::vector<std::string> there = plantsOf(package);
    if (std::find(there.begin(), there.end(), plant) != there.end()) {
      return ros::package::getPath(package) + "/config/" + plant + ".yaml";
    }
    if (!ours) {
      problem += ", and in package " + package + " " + (there.empty() ? "none" : join(there, ", "));
    }
  } catch (const std::invalid_argument& e) {
    problem += std::string("; ") + e.what();
  }
  throw std::invalid_argument(problem);
}

}  // namespace ddm
