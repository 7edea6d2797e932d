// Prepares the model and the data that an experiment, or a resumed experiment, starts from.
// SPDX-License-Identifier: BSD-3-Clause
#include "start.h"

#include <ddm_bag_io/bag_cache.h>
#include <ddm_bag_io/bag_reader.h>
#include <ddm_common/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_mpc/controller.h>
#include <ddm_sim/plant.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <cmath>
#include <iostream>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr double kRateTolerance = 0.1;  // largest deviation of the time step [fraction of dt]

/// Makes a path absolute. Fills in a missing checksum of the file or compares it with the given
/// one.
/// @throws std::invalid_argument if the checksum differs
void identify(std::string* path, std::string* checksum) {
  *path = boost::filesystem::absolute(*path).lexically_normal().string();
  // The prefix keeps YAML readers from parsing the checksum as a number.
  const std::string here = "crc32-" + ddm::checksum(readFile(*path));
  if (!checksum->empty() && *checksum != here) {
    throw std::invalid_argument(*path + " has changed: its checksum was " + *checksum + ", it is " +
                                here + " now; put it back, or start another experiment");
  }
  *checksum = here;
}

/// Checks that a bag was recorded with this plant or robot: number of torques, camera and time
/// step.
/// @throws std::invalid_argument naming the first difference
void requireFits(const std::string& path, const Configuration& configuration, const Plant& plant,
                 DifferentBags* different) {
  const bool robot = configuration.robot.has_value();
  const int size = configuration.model.image.size;
  const RenderedImage rendered =
      robot ? RenderedImage{size, size, 1, {}, {}} : plant.render(plant.state());
  const std::string camera = std::to_string(rendered.width) + "x" +
                             std::to_string(rendered.height) +
                             (rendered.channels == 1 ? " mono8" : " rgb8");
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

std::string firstTrial(const StartOptions& start) {
  if (start.empty()) return "a random one";
  return "one that starts from " + std::to_string(start.bags.size()) + " bag(s) and " +
         (start.model.empty() ? "the model trained on them" : "model " + start.model);
}

/// Number of episodes of this trial that an earlier call has recorded completely.
/// @throws std::runtime_error if a bag of this trial or of an earlier trial cannot be read
int requireReadableBags(int trial, const Configuration& configuration, const RunFolder& folder) {
  const ModelConfig& learner = configuration.model;
  BagCache cache(learner.image.size, learner.data_set);
  std::vector<std::string> bags = folder.bagsUpTo(trial - 1);
  if (trial > 0) cache.read(bags);
  const size_t num_before = bags.size();
  for (int episode = 0; episode < configuration.trial.episodes; ++episode) {
    if (!folder.isRecorded({trial, /*evaluation=*/false, episode})) continue;
    bags.push_back(folder.bagPath(trial, episode));
  }
  if (bags.size() == num_before) return 0;
  try {
    cache.read(bags);
  } catch (const std::exception& e) {
    throw std::runtime_error(std::string(e.what()) + "; this bag is the recording of trial " +
                             std::to_string(trial) + ", which is not finished: repair it, or " +
                             "move it away and the trial is run again");
  }
  return static_cast<int>(bags.size() - num_before);
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
  const size_t num_files = start.bags.size() + (start.model.empty() ? 0 : 1);
  if (start.checksums.empty()) start.checksums.resize(num_files);
  if (start.checksums.size() != num_files) {
    throw std::invalid_argument("start/checksums must have " + std::to_string(num_files) +
                                " entries, one for each of start/bags and the last for "
                                "start/model, got " +
                                std::to_string(start.checksums.size()) + ": leave them out");
  }
  if (!start.model.empty()) {
    identify(&start.model, &start.checksums.back());
    requireModelFits(readModel(start.model), start.model, *configuration);
  }
  const std::unique_ptr<Plant> plant = makePlant(*configuration->plant);
  DifferentBags different;
  for (size_t i = 0; i < start.bags.size(); ++i) {
    identify(&start.bags[i], &start.checksums[i]);
    requireFits(start.bags[i], *configuration, *plant, &different);
  }
}

void announce(const Configuration& configuration, const RunFolder& folder, Progress* progress) {
  const ExperimentOptions& options = configuration.experiment;
  for (const std::string& warning : folder.warnings()) progress->note("warning: " + warning);
  progress->note("preset " + options.preset + ", plant " + options.plant + ", seed " +
                 std::to_string(options.seed) + ", " + std::to_string(options.trials) +
                 " trials after " + firstTrial(configuration.start));
  const int num_finished = static_cast<int>(folder.rows().size());
  if (num_finished > options.trials) {
    progress->note("all " + std::to_string(num_finished) +
                   " trials are finished already: nothing is run");
  } else if (num_finished > 0) {
    progress->note("resuming after trial " + std::to_string(num_finished - 1));
  }
}

void resumeTrial(int trial, const Configuration& configuration, Driver* driver,
                 const RunFolder& folder, Progress* progress) {
  const int num_recorded = requireReadableBags(trial, configuration, folder);
  if (num_recorded == configuration.trial.episodes) return;  // no exploration is left to do
  const StartOptions& start = configuration.start;
  if (trial == 0 && !start.model.empty()) {
    if (driver->useModel(start.model)) return;
    throw std::logic_error("method " + configuration.experiment.method + " cannot use the model " +
                           start.model);
  }
  if (trial == 0 && start.bags.empty()) return;  // the first trial is random
  const int before = std::max(trial - 1, 0);
  const std::vector<std::string> bags = folder.bagsUpTo(trial - 1);
  const TrialId id = requestFor(configuration, before, /*evaluation=*/false).id;
  if (trial > 0 && driver->resume(folder.trainingPath(before), bags, id)) return;
  progress->beginPhase(before, "train");
  driver->train(bags, id, [progress](double fraction) { progress->update(fraction); });
}

}  // namespace ddm
