// What an experiment starts from instead of nothing: a saved model, and bags.
// SPDX-License-Identifier: BSD-3-Clause
#include "start.h"

#include <ddm_bag_io/bag_reader.h>
#include <ddm_files/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_sim/plant_factory.h>

#include <boost/filesystem.hpp>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "saved_model.h"

namespace ddm {
namespace {

constexpr double kRateTolerance = 0.1;  // of dt

/// Makes a path absolute and fills its id in, or compares it with the one that is there.
void identify(std::string* path, std::string* id) {
  *path = boost::filesystem::absolute(*path).lexically_normal().string();
  const std::string here = "crc32-" + checksum(readFile(*path));  // no YAML takes it for a number
  if (!id->empty() && *id != here) {
    throw std::invalid_argument(*path + " has changed: its id was " + *id + ", it is " + here +
                                " now; put it back, or start another experiment");
  }
  *id = here;
}

/// What the trials to come will be like.
struct Trials {
  int torque_dim;
  std::string camera;  ///< as BagContent::camera
  double dt;
  std::string whose;  ///< "the plant", "the robot"
};

/// A robot's images come from robot_node, at the model's size.
Trials trialsOf(const Configuration& configuration, const Plant& plant) {
  const auto camera = [](int width, int height, const char* encoding) {
    return std::to_string(width) + "x" + std::to_string(height) + " " + encoding;
  };
  if (configuration.robot) {
    const RobotOptions& robot = *configuration.robot;
    const int size = configuration.model.image.size;
    return {robot.numMotors(), camera(size, size, "mono8"), robot.dt, "the robot"};
  }
  const Picture picture = plant.render(plant.state());
  return {plant.torqueDim(),
          camera(picture.width, picture.height, picture.channels == 1 ? "mono8" : "rgb8"),
          plant.info().dt, "the plant"};
}

void requireFits(const std::string& path, const Configuration& configuration,
                 const Trials& trials) {
  const BagContent bag =
      readBag(path, configuration.model.image.size, configuration.model.data_set);
  const auto require = [&](bool ok, const std::string& what, const auto& has, const auto& wants) {
    if (ok) return;
    std::ostringstream text;
    text << "bag " << path << " does not fit " << trials.whose << ": " << what << ": " << has
         << " in the bag, " << wants << " in the trials to come; leave the bag out, or choose what "
         << "it was recorded on";
    throw std::invalid_argument(text.str());
  };
  require(bag.data.torqueDim() == trials.torque_dim, "torques a frame", bag.data.torqueDim(),
          trials.torque_dim);
  require(bag.camera == trials.camera, "images", bag.camera, trials.camera);
  const bool same_rate =
      bag.interval == 0.0 || std::abs(bag.interval - trials.dt) <= kRateTolerance * trials.dt;
  require(same_rate, "seconds between frames (dt)", bag.interval, trials.dt);
}

}  // namespace

void prepareStart(Configuration* configuration) {
  StartOptions& start = configuration->start;
  if (start.empty()) return;
  if (configuration->experiment.method != "ddm") {
    throw std::invalid_argument("an experiment with method " + configuration->experiment.method +
                                " cannot start from a model or bags: only ddm can");
  }
  const std::unique_ptr<Plant> plant = makePlant(*configuration->plant);
  if (!start.model.empty()) {
    identify(&start.model, &start.model_id);
    makeModelPolicy(readModel(start.model), start.model, *configuration, *plant);
  }
  if (start.bag_ids.empty()) start.bag_ids.resize(start.bags.size());
  if (start.bag_ids.size() != start.bags.size()) {
    throw std::invalid_argument(
        "start/bag_ids must have one entry for each of start/bags, or none");
  }
  std::set<std::string> seen;
  for (size_t i = 0; i < start.bags.size(); ++i) {
    identify(&start.bags[i], &start.bag_ids[i]);
    if (!seen.insert(start.bags[i]).second) {
      throw std::invalid_argument("bag " + start.bags[i] + " is given twice: it would count twice");
    }
    requireFits(start.bags[i], *configuration, trialsOf(*configuration, *plant));
  }
}

}  // namespace ddm
