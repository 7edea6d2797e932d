// The block `plant` of any plant, ours or another package's, and the file that describes it.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_plant_plugin/plant_config.h"

#include <ros/package.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <stdexcept>
#include <vector>

#include "ddm_plant_plugin/plant_plugin.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

/// `plant/type` alone, which decides what other keys there are.
struct TypeOption {
  std::string type = PlantBasics().type;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("type", type);
  }
  std::vector<std::string> problems() const { return {}; }
};

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::shared_ptr<PlantPlugin> loadPlugin(const std::string& type) {
  // Never destroyed: the plants that it has loaded, and their code, live until the program ends.
  static auto* const loader =
      new pluginlib::ClassLoader<PlantPlugin>("ddm_sim", "ddm::PlantPlugin");
  if (!loader->isClassAvailable(type)) {
    const std::vector<std::string> known = loader->getDeclaredClasses();
    throw std::invalid_argument("plant/type must be a plant of this workspace, got \"" + type +
                                "\": there are " + joined(plantTypes()) + " and as plugins " +
                                (known.empty() ? "none" : joined(known)) +
                                "; source the setup.bash of the workspace that holds it");
  }
  try {
    return loader->createUniqueInstance(type);
  } catch (const pluginlib::PluginlibException& e) {
    throw std::runtime_error("the plugin " + type + " of plant/type cannot be loaded: " + e.what());
  }
}

/// Names of the plants that the folder config/ of a package describes.
/// @throws std::invalid_argument if there is no such package
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

}  // namespace

PlantOptions readPlant(ParamReader* reader) {
  ParamReader ahead = *reader;  // a copy: what it finds wrong is not yet known to be wrong
  const std::string type = ahead.read<TypeOption>("plant").type;
  if (type.find('/') == std::string::npos) return reader->read<PlantOptions>("plant");
  const std::shared_ptr<PlantPlugin> plugin = loadPlugin(type);
  plugin->read(reader);
  PlantOptions plant;
  static_cast<PlantBasics&>(plant) = plugin->basics();
  plant.maker = plugin;
  return plant;
}

YAML::Node plantBlock(const PlantOptions& plant) {
  if (plant.maker == nullptr) return toYaml(plant);
  return static_cast<const PlantPlugin&>(*plant.maker).effectiveBlock();
}

std::string plantFile(const std::string& name) {
  const std::string::size_type slash = name.find('/');
  const bool ours = slash == std::string::npos;
  const std::string package = ours ? "ddm_sim" : name.substr(0, slash);
  const std::string plant = ours ? name : name.substr(slash + 1);
  std::string problem = "unknown plant '" + name + "': there are " + joined(plantsOf("ddm_sim"));
  try {
    const std::vector<std::string> there = plantsOf(package);
    if (std::find(there.begin(), there.end(), plant) != there.end()) {
      return ros::package::getPath(package) + "/config/" + plant + ".yaml";
    }
    if (!ours) {
      problem += ", and in package " + package + " " + (there.empty() ? "none" : joined(there));
    }
  } catch (const std::invalid_argument& e) {
    problem += std::string("; ") + e.what();
  }
  throw std::invalid_argument(problem);
}

}  // namespace ddm
