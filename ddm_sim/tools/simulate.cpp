// simulate: reads torques, simulates a plant without a ROS master, and writes the trajectory.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_codec.h>
#include <ddm_plant_plugin/image_message.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/optional.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_common/param_reader.h"
#include "ddm_common/param_value.h"
#include "ddm_common/tool.h"
#include "ddm_sim/plant.h"
#include "number_csv.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

constexpr char kAbout[] =
    "Moves a plant under given torques.\n\n"
    "usage: rosrun ddm_sim simulate --plant NAME [options] < torques.csv > trajectory.csv\n\n"
    "Input:  a header, then N lines with one torque each. The header is `torque` of --describe,\n"
    "        such as torque_nm for a pendulum. A torque beyond the plant's max_torque saturates,\n"
    "        as the motor does.\n"
    "Output: a header, then N + 1 rows; row 0 is the initial state. The header is step,time_s and\n"
    "        `state` of --describe; angles are not wrapped. A plant with a reward also has\n"
    "        `reward`, of this state under the torque of the row before (row 0: no torque).\n"
    "        Nothing is written if any of the input is wrong.\n"
    "Exit:   0 done, 1 bad data, 2 bad options.\n\n"
    "Options";

struct Arguments {
  std::string plant;
  boost::optional<std::string> start;   ///< initial state: all components
  boost::optional<std::string> target;  ///< target point of the goal
  std::string frames;                   ///< folder for the rendered images; empty: no images
  /// Print a description of the plant instead of a trajectory.
  bool describe = false;
  std::vector<std::string> configs;
};

/// @return false if the only option is --help, whose text has been printed
/// @throws po::error if the arguments are wrong
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(kAbout);
  auto add = options.add_options();
  add("plant", po::value(&arguments->plant)->required()->value_name("NAME"),
      "a file config/NAME.yaml of this package; PACKAGE/NAME: of another one");
  add("start", po::value(&arguments->start)->value_name("V1,V2,..."),
      "start state, taken exactly: the columns of the output after time_s; without it a pendulum "
      "hangs at rest and a tile is in the middle");
  add("target", po::value(&arguments->target)->value_name("X,Y"),
      "place to reach, on which the reward depends, for plants that draw one in each trial [m]; "
      "without it the goal is the one of the plant's file");
  add("frames", po::value(&arguments->frames)->value_name("DIR"),
      "also write one rendered image for each row, without disturbances of the camera: "
      "DIR/frame_0000.png, ... The folder is made if necessary; images of these names are "
      "replaced");
  add("describe", po::bool_switch(&arguments->describe),
      "print as YAML what the plant says of itself, its joints, units, limits, start, goal and "
      "tolerance, and what draws it, and exit");
  add("config", po::value(&arguments->configs)->value_name("FILE")->composing(),
      "YAML file with overrides of the block `plant`; repeatable, later wins");
  std::vector<std::string> words;
  const Positional unnamed{"word", po::value(&words), -1};
  // Disables short options and abbreviations, so that a word like -0.5 is always a value and never
  // an option.
  namespace style = po::command_line_style;
  constexpr int kStyle = style::allow_long | style::long_allow_adjacent | style::long_allow_next;
  if (!parseCommandLine(argc, argv, options, unnamed, kStyle)) return false;
  if (words.empty()) return true;
  throw po::error("unexpected \"" + words.front() + "\"; each value needs its option");
}

/// @throws po::error with the known plants if no plant has this name
std::shared_ptr<const PlantPlugin> configuredPlant(const Arguments& arguments) {
  std::vector<std::string> files;
  try {
    files.push_back(plantFile(arguments.plant));
  } catch (const std::invalid_argument& e) {
    throw po::error(std::string("option --plant: ") + e.what());
  }
  files.insert(files.end(), arguments.configs.begin(), arguments.configs.end());
  return readPlantFiles(files);
}

void writeFrame(const Plant& plant, const std::string& folder, std::size_t row) {
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04zu.png", row);
  writeImageFile((fs::path(folder) / name).string(),
                 imageMessage(plant.render(plant.state()), ros::Time()));
}

/// @param reward  empty: the plant has no reward
std::string csvRow(const Plant& plant, std::size_t row, const std::optional<double>& reward) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.17g", value);
    return "," + std::string(text);
  };
  std::string text = std::to_string(row) + number(static_cast<double>(row) * plant.info().dt);
  for (Eigen::Index i = 0; i < plant.state().size(); ++i) text += number(plant.state()[i]);
  if (reward && !std::isfinite(*reward)) {
    throw std::range_error("plant " + plant.info().type + ": the reward of row " +
                           std::to_string(row) + " must be finite, got " + formatDouble(*reward) +
                           ": correct the plant");
  }
  if (reward) text += number(*reward);
  return text + "\n";
}

void setStart(const Arguments& arguments, Plant* plant) {
  if (!arguments.start) return;
  Eigen::VectorXd state;
  if (!parseNumbers(*arguments.start, plant->stateDim(), &state)) {
    throw po::error("option --start must be " + std::to_string(plant->stateDim()) +
                    " finite number(s) (" + boost::join(plant->info().state_names, ",") +
                    "), got \"" + *arguments.start + "\"");
  }
  plant->setState(state);
}

void setTarget(const Arguments& arguments, Plant* plant) {
  if (!arguments.target) return;
  const auto size = 1 + std::count(arguments.target->begin(), arguments.target->end(), ',');
  Eigen::VectorXd target;
  if (!parseNumbers(*arguments.target, size, &target)) {
    throw po::error("option --target must be finite numbers, got \"" + *arguments.target + "\"");
  }
  try {
    plant->setGoal(plant->goalAt(target));
  } catch (const std::invalid_argument& e) {
    throw po::error(std::string("option --target: ") + e.what());
  }
}

YAML::Node numbers(const Eigen::VectorXd& values) {
  return valueToYaml(std::vector<double>(values.data(), values.data() + values.size()));
}

/// Description of a plant as YAML. The names in `state` and `torque` end with their units.
/// @param renderer  driver that draws the images; empty: the images do not depend on a driver
std::string describe(const PlantInfo& info, const std::string& renderer) {
  YAML::Node about;
  for (const Joint& joint : info.joints) {
    YAML::Node entry;
    entry.SetStyle(YAML::EmitterStyle::Flow);
    entry["name"] = joint.name;
    entry["kind"] = joint.kind == JointKind::kAngle ? "angle" : "length";
    about["joints"].push_back(entry);
  }
  about["state"] = valueToYaml(info.state_names);
  about["torque"] = valueToYaml(info.torque_names);
  about["max_torque"] = numbers(info.max_torque);
  about["dt"] = valueToYaml(info.dt);
  about["start"] = numbers(info.start);
  about["start_std"] = numbers(info.start_std);
  about["goal"] = numbers(info.goal);
  about["error_unit"] = info.error_unit;
  about["tolerance"] = valueToYaml(info.tolerance);
  if (info.evaluation_steps > 0) about["evaluation_steps"] = info.evaluation_steps;
  if (!renderer.empty()) about["renderer"] = renderer;
  return YAML::Dump(about) + "\n";
}

/// Simulates the torques of standard input, and returns the trajectory as CSV.
std::string simulated(const Arguments& arguments, Plant* plant) {
  setStart(arguments, plant);
  setTarget(arguments, plant);
  const std::vector<Eigen::VectorXd> torques =
      readNumbers(std::cin, plant->info().torque_names, "a torque");
  if (!arguments.frames.empty()) fs::create_directories(arguments.frames);

  std::optional<double> reward =
      plant->reward(plant->state(), Eigen::VectorXd::Zero(plant->torqueDim()));
  std::string trajectory =
      "step,time_s," + boost::join(plant->info().state_names, ",") + (reward ? ",reward\n" : "\n");
  for (std::size_t row = 0; row <= torques.size(); ++row) {
    if (row > 0) {
      const Eigen::VectorXd applied = plant->step(torques[row - 1]);
      reward = plant->reward(plant->state(), applied);
    }
    trajectory += csvRow(*plant, row, reward);
    if (!arguments.frames.empty()) writeFrame(*plant, arguments.frames, row);
  }
  return trajectory;
}

void simulate(const Arguments& arguments) {
  const std::shared_ptr<const PlantPlugin> maker = configuredPlant(arguments);
  const std::unique_ptr<Plant> plant = makePlant(*maker);
  std::cout << (arguments.describe ? describe(plant->info(), maker->renderer())
                                   : simulated(arguments, plant.get()))
            << std::flush;
  if (!std::cout) throw std::runtime_error("standard output cannot be written");
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  try {
    ddm::Arguments arguments;
    if (ddm::parse(argc, argv, &arguments)) ddm::simulate(arguments);
  } catch (const boost::program_options::error& e) {  // an error in the arguments, not in the data
    std::cerr << "simulate: " << e.what() << "\nsimulate --help lists the options\n";
    return ddm::kUsageError;
  } catch (const std::exception& e) {
    std::cerr << "simulate: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
