// What an experiment starts from instead of nothing: a saved model, and bags.
// SPDX-License-Identifier: BSD-3-Clause
#include "start.h"

#include <ddm_bag_io/bag_reader.h>
#include <ddm_common/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_mpc/controller.h>
#include <ddm_sim/plant_factory.h>

#include <boost/filesystem.hpp>
#include <cmath>
#include <iostream>
#include <sstream>
#include <stdexcept>

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

/// A bag must have been recorded on such a plant or robot, whose images come at the model's size.
void requireFits(const std::string& path, const Configuration& configuration, const Plant& plant,
                 DifferentFrames* different) {
  const bool robot = configuration.robot.has_value();
  const int size = configuration.model.image.size;
  const Picture picture = robot ? Picture{size, size, 1, {}, {}} : plant.render(plant.state());
  const std::string camera = std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                             (picture.channels == 1 ? " mono8" : " rgb8");
  const auto torque_dim = static_cast<int>(torqueNames(configuration).size());
  const double dt = robot ? configuration.robot->dt : plant.info().dt;
  const BagContent bag = readBag(path, size, configuration.model.data_set);
  const auto require = [&](bool ok, const std::string& what, const auto& has, const auto& wants) {
    if (ok) return;
    std::ostringstream text;
    text << "bag " << path << " does not fit the " << (robot ? "robot" : "plant") << ": " << what
         << ": " << has << " in the bag, " << wants << " in the trials to come; leave the bag out, "
         << "or choose what it was recorded on";
    throw std::invalid_argument(text.str());
  };
  require(bag.data.torqueDim() == torque_dim, "torques a frame", bag.data.torqueDim(), torque_dim);
  const bool fits = bag.camera == camera || configuration.model.data_set.ofOthers();
  require(fits, "images", bag.camera, camera);
  const bool same_rate = bag.interval == 0.0 || std::abs(bag.interval - dt) <= kRateTolerance * dt;
  require(same_rate, "seconds between frames (dt)", bag.interval, dt);
  different->require(path, bag);
  for (const std::string& note : bag.notes) {
    std::cerr << "warning: bag " << path << ": " << note << "\n";
  }
}

}  // namespace

std::shared_ptr<const Ddm> readModel(const std::string& path) {
  return std::make_shared<const Ddm>(deserialiseModel(readFile(path), path));
}

void requireModelFits(const std::shared_ptr<const Ddm>& model, const std::string& source,
                      const Configuration& configuration) {
  const auto requireEqual = [&source](const std::string& what, int ours, const std::string& of,
                                      int theirs, const std::string& remedy) {
    if (ours == theirs) return;
    throw std::invalid_argument("model " + source + " has " + what + " " + std::to_string(ours) +
                                ", " + of + " " + std::to_string(theirs) + ": " + remedy);
  };
  requireEqual("images of size", model->imageSize(), "image/size is",
               configuration.model.image.size, "set image/size to the model's");
  const bool robot = configuration.robot.has_value();
  requireEqual(
      "a number of torques of", model->torqueDim(), robot ? "the robot" : "the plant",
      static_cast<int>(torqueNames(configuration).size()),
      robot ? "give robot/max_torque a number for each motor, or choose a model of this robot"
            : "choose the plant that it was trained on");
  try {
    MpcPolicy(model, configuration.mpc);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument("model " + source + ": " + e.what());
  }
}

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
    requireModelFits(readModel(start.model), start.model, *configuration);
  }
  if (start.bag_ids.empty()) start.bag_ids.resize(start.bags.size());
  if (start.bag_ids.size() != start.bags.size()) {
    throw std::invalid_argument(
        "start/bag_ids must have one entry for each of start/bags, or none");
  }
  requireDifferentBags(start.bags);
  DifferentFrames different;
  for (size_t i = 0; i < start.bags.size(); ++i) {
    identify(&start.bags[i], &start.bag_ids[i]);
    requireFits(start.bags[i], *configuration, *plant, &different);
  }
}

}  // namespace ddm
