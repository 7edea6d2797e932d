// A small configuration, table rows and a driver that records its calls, for tests of experiments.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_writer.h>
#include <ddm_common/image_codec.h>
#include <ddm_msgs/Torque.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_plant_plugin/testing/toy_plant.h>
#include <ddm_sim/plant.h>
#include <sys/stat.h>

#include <boost/filesystem.hpp>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "configuration.h"
#include "driver.h"
#include "run_folder.h"

namespace ddm {
namespace testing {

constexpr int kToySteps = 30;

/// Sets the plant of a configuration and all values that depend on the plant.
inline void usePlant(std::shared_ptr<const PlantPlugin> plant, Configuration* all) {
  all->plant = std::move(plant);
  all->plant_info = makePlant(*all->plant)->info();
}

/// @param block  block `plant` as YAML, e.g. {type: moving_tile, dt: 0.1}
inline std::shared_ptr<const PlantPlugin> plantOf(const std::string& block) {
  YAML::Node blocks;
  blocks["plant"] = YAML::Load(block);
  ParamReader reader(blocks);
  auto plant = readPlant(&reader);
  reader.requireValid();
  return plant;
}

inline std::shared_ptr<const PlantPlugin> plantOf(const ToyPlant::Traits& traits) {
  return std::make_shared<ToyPlugin>(traits);
}

/// @param runs  folder for the results
inline Configuration toyConfiguration(const std::string& runs) {
  Configuration all;
  all.experiment.runs = runs;
  all.experiment.seed = 7;
  all.experiment.trials = 2;
  all.trial.num_steps = kToySteps;
  all.model.model.pca_dim = 10;
  usePlant(plantOf("{type: pendulum}"), &all);
  return all;
}

inline TrialRow toyRow(int trial, int seed = 7) {
  TrialRow row;
  row.seed = seed;
  row.trial = trial;
  row.frames = static_cast<std::uint32_t>(kToySteps * (trial + 1));
  row.evaluation.known = true;
  row.evaluation.success = trial % 2 == 1;
  row.evaluation.final_error = 0.1 * (trial + 1);
  row.v_r = 1.0 / 3.0;
  row.v_p = 1e-7;
  row.train_s = 0.125;
  row.train_evaluations = 26;
  row.plan_ms_median = 0.25;
  row.plan_ms_p99 = 1.5;
  row.version = "1.2.3 (abcdef0)";
  return row;
}

inline std::string textOf(const std::string& path) {
  const std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline void writeText(const std::string& path, const std::string& text) {
  std::ofstream(path) << text;
}

/// Content and modification time of each file of a folder, by name.
inline std::map<std::string, std::string> fingerprintOf(const std::string& folder) {
  namespace fs = boost::filesystem;
  std::map<std::string, std::string> found;
  const auto take = [&found](const fs::path& path) {
    struct stat status {};
    ::stat(path.c_str(), &status);
    found[path.string()] = std::to_string(status.st_mtim.tv_sec) + "." +
                           std::to_string(status.st_mtim.tv_nsec) + " " + textOf(path.string());
  };
  for (const auto& entry : fs::recursive_directory_iterator(folder)) take(entry.path());
  return found;
}

/// Writes a bag with one black image.
inline void writeToyBag(const std::string& path) {
  const int size = ImageOptions().size;
  BagWriter bag(path, BagOptions());
  bag.write(encodeImage(Image(static_cast<std::size_t>(size) * size, 0), size, ros::Time(1.0), ""));
  ddm_msgs::Torque torque;
  torque.header.stamp = ros::Time(1.0);
  torque.torque = {0.0};
  bag.write(torque);
  bag.close();
}

/// Records all calls. Each greedy evaluation ends in `state`.
class ObedientDriver : public Driver {
 public:
  TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) override {
    calls.push_back((request.id.evaluation ? "evaluate " : "run ") +
                    std::to_string(request.id.trial));
    requests.push_back(request);
    if (calls.size() == fails_at) throw std::runtime_error("the camera fell down");
    if (!request.bag.empty()) writeToyBag(request.bag);
    progress(1.0);
    TrialOutcome outcome;
    for (int step = 0; step < request.num_steps; ++step) {
      outcome.torques.push_back(Eigen::VectorXd::Constant(1, 0.1 * step));
      outcome.exploratory.push_back(request.epsilon > 0.0);
      outcome.solve_times.push_back(1e-3 * (step + 1));
      if (goal_distance) outcome.goal_distances.push_back(*goal_distance);
      if (state.size() == 0) continue;
      outcome.times.push_back(0.2 * step);
      outcome.states.push_back(state);
    }
    return outcome;
  }

  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override {
    calls.push_back("train " + std::to_string(id.trial));
    bags_of_training.push_back(bags);
    if (calls.size() == fails_at) throw std::runtime_error("the numbers ran away");
    progress(0.5);
    TrainingOutcome outcome;
    outcome.files["model.ddm"] = "model " + std::to_string(id.trial);
    outcome.frames = static_cast<std::uint32_t>(kToySteps * bags.size());
    outcome.v_r = 0.5;
    outcome.v_p = 0.25;
    outcome.seconds = 2.0;
    return outcome;
  }

  bool useModel(const std::string& path) override {
    if (!has_models) return false;
    calls.push_back("use " + path);
    if (calls.size() == fails_at) throw std::runtime_error("the model is damaged");
    return true;
  }

  bool has_models = true;               ///< whether models can be saved
  size_t fails_at = 0;                  ///< number of the call that throws, from 1; 0: none
  Eigen::VectorXd state;                ///< empty: no ground truth
  std::optional<double> goal_distance;  ///< distance of each image
  std::vector<std::string> calls;
  std::vector<TrialRequest> requests;
  std::vector<std::vector<std::string>> bags_of_training;
};

}  // namespace testing
}  // namespace ddm
