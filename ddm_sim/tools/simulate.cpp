// simulate: moves a plant under given torques, without a master. Torques in, trajectory out.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_plant_plugin/plant_config.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/program_options.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_params/param_reader.h"
#include "ddm_sim/plant_factory.h"
#include "plant_description.h"
#include "torque_csv.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

constexpr int kExitData = 1;
constexpr int kExitUsage = 2;

constexpr char kAbout[] =
    "Moves a plant under given torques.\n\n"
    "usage: rosrun ddm_sim simulate --plant NAME [options] < torques.csv > trajectory.csv\n\n"
    "Input:  a header, then one torque a line, N of them. The header is torque_nm for a pendulum\n"
    "        [N m] and dx_px,dy_px for a moving tile [pixels]. A torque beyond the plant's\n"
    "        max_torque saturates, as the motor does.\n"
    "Output: a header, then N + 1 rows; row 0 is the start. The header is\n"
    "        step,time_s,angle_rad,rate_rad_per_s for a pendulum, whose angle is not wrapped, and\n"
    "        step,time_s,x_px,y_px for a moving tile. Nothing is written if any of the input is\n"
    "        wrong.\n"
    "Exit:   0 done, 1 bad data, 2 bad options.\n\n"
    "Options";

/// Wrong use of the command line, as opposed to wrong data.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Arguments {
  std::string plant;
  std::string start;            ///< whole start state, empty = not given
  std::optional<double> angle;  ///< [rad]
  std::optional<double> rate;   ///< [rad/s]
  std::string frames;           ///< folder, empty = none
  bool describe = false;        ///< say what the plant is instead
  std::vector<std::string> configs;
};

/// @return nothing if the user did not give it
std::optional<double> finiteOption(const po::variables_map& given, const std::string& name) {
  if (given[name].defaulted()) return std::nullopt;
  double value = 0.0;
  const auto& text = given[name].as<std::string>();
  if (!parseNumber(text, &value)) {
    throw UsageError("option --" + name + " must be a finite number, got \"" + text + "\"");
  }
  return value;
}

po::options_description describedOptions() {
  using Text = std::string;
  po::options_description options(kAbout);
  auto add = options.add_options();
  add("help", "print this and exit");
  add("plant", po::value<Text>()->value_name("NAME"),
      "a file config/NAME.yaml of this package; PACKAGE/NAME: of another one");
  add("start", po::value<Text>()->value_name("V1,V2,..."),
      "start state, taken exactly: the columns of the output after time_s; without it a pendulum "
      "hangs at rest and a tile is in the middle");
  add("angle", po::value<Text>()->value_name("RAD")->default_value("0"),
      "pendulum: start angle [rad], taken exactly; 0 hangs, counter-clockwise is positive");
  add("rate", po::value<Text>()->value_name("RAD_PER_S")->default_value("0"),
      "pendulum: start rate [rad/s], taken exactly");
  add("frames", po::value<Text>()->value_name("DIR"),
      "also write one picture a row, without nuisances of the camera: DIR/frame_0000.png, ... The "
      "folder is made if need be; pictures of these names in it are replaced");
  add("describe",
      "print as YAML what the plant says of itself, its joints, units, limits, start, goal and "
      "tolerance, and exit");
  add("config", po::value<std::vector<Text>>()->value_name("FILE"),
      "YAML file with overrides of the block `plant`; repeatable, later wins");
  return options;
}

/// @return false if only help was asked for, and printed
bool parseArguments(int argc, char** argv, Arguments* arguments) {
  const po::options_description options = describedOptions();
  po::variables_map given;
  try {
    // No short options and no abbreviations: a word like -0.5 is then a value and never an option.
    namespace style = po::command_line_style;
    constexpr int kStyle = style::allow_long | style::long_allow_adjacent | style::long_allow_next;
    const po::parsed_options parsed =
        po::command_line_parser(argc, argv).options(options).style(kStyle).run();
    for (const po::option& option : parsed.options) {
      if (option.position_key < 0) continue;  // a word that belongs to an option
      throw UsageError("unexpected \"" + option.value.front() + "\"; each value needs its option");
    }
    po::store(parsed, given);
  } catch (const po::error& e) {
    throw UsageError(e.what());
  }
  if (given.count("help") != 0) {
    std::cout << options;
    return false;
  }
  if (given.count("plant") == 0) throw UsageError("option --plant NAME is missing");
  arguments->plant = given["plant"].as<std::string>();
  arguments->describe = given.count("describe") != 0;
  arguments->angle = finiteOption(given, "angle");
  arguments->rate = finiteOption(given, "rate");
  if (given.count("start") != 0) {
    if (arguments->angle || arguments->rate) {
      throw UsageError("option --start gives the whole state; leave --angle and --rate out");
    }
    arguments->start = given["start"].as<std::string>();
    if (arguments->start.empty()) throw UsageError("option --start must not be empty");
  }
  if (given.count("frames") != 0) arguments->frames = given["frames"].as<std::string>();
  if (given.count("config") != 0) {
    arguments->configs = given["config"].as<std::vector<std::string>>();
  }
  return true;
}

/// The files that describe camera and plant, then the user's own.
/// @throws UsageError with the known plants if there is none of this name
std::vector<std::string> configFiles(const Arguments& arguments) {
  std::vector<std::string> files{ros::package::getPath("ddm_sim") + "/config/sim.yaml"};
  try {
    files.push_back(plantFile(arguments.plant));
  } catch (const std::invalid_argument& e) {
    throw UsageError(std::string("option --plant: ") + e.what());
  }
  files.insert(files.end(), arguments.configs.begin(), arguments.configs.end());
  return files;
}

std::unique_ptr<Plant> configuredPlant(const Arguments& arguments) {
  ParamReader params = ParamReader::fromFiles(configFiles(arguments));
  const auto plant = readPlant(&params);
  params.requireValid();
  return makePlant(*plant);
}

void writeFrame(const Plant& plant, const std::string& folder, std::size_t row) {
  Picture picture = plant.render(plant.state());
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04zu.png", row);
  const std::string path = (fs::path(folder) / name).string();
  const int type = picture.channels == 1 ? CV_8UC1 : CV_8UC3;
  cv::Mat image(picture.height, picture.width, type, picture.bytes.data());
  if (picture.channels == 3) cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  bool written = false;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception&) {  // the path below says more than its text
  }
  if (!written)
    throw std::runtime_error(path + " cannot be written; check the folder and its disk");
}

std::string csvRow(const Plant& plant, std::size_t row) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.17g", value);
    return "," + std::string(text);
  };
  std::string text = std::to_string(row) + number(static_cast<double>(row) * plant.info().dt);
  for (Eigen::Index i = 0; i < plant.state().size(); ++i) text += number(plant.state()[i]);
  return text + "\n";
}

/// Sets the component `name` of the state, if a value was given for it by `option`.
void setComponent(const std::string& option, const std::optional<double>& value,
                  const std::string& name, Plant* plant) {
  if (!value) return;
  const std::vector<std::string> names = plant->info().state_names;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw UsageError("option " + option + " is for a pendulum; the state of this plant is " +
                     joinedByCommas(names) + ", use --start");
  }
  Eigen::VectorXd state = plant->state();
  state[found - names.begin()] = *value;
  plant->setState(state);
}

void setStart(const Arguments& arguments, Plant* plant) {
  setComponent("--angle", arguments.angle, "angle_rad", plant);
  setComponent("--rate", arguments.rate, "rate_rad_per_s", plant);
  if (arguments.start.empty()) return;
  Eigen::VectorXd state;
  if (!parseNumbers(arguments.start, plant->stateDim(), &state)) {
    throw UsageError("option --start must be " + std::to_string(plant->stateDim()) +
                     " finite number(s) (" + joinedByCommas(plant->info().state_names) +
                     "), got \"" + arguments.start + "\"");
  }
  plant->setState(state);
}

void simulate(const Arguments& arguments) {
  const std::unique_ptr<Plant> plant = configuredPlant(arguments);
  if (arguments.describe) {
    std::cout << describe(plant->info());
    return;
  }
  setStart(arguments, plant.get());
  const std::vector<Eigen::VectorXd> torques = readTorques(std::cin, plant->info().torque_names);
  if (!arguments.frames.empty()) fs::create_directories(arguments.frames);

  std::string trajectory = "step,time_s," + joinedByCommas(plant->info().state_names) + "\n";
  for (std::size_t row = 0; row <= torques.size(); ++row) {
    if (row > 0) plant->step(torques[row - 1]);
    trajectory += csvRow(*plant, row);
    if (!arguments.frames.empty()) writeFrame(*plant, arguments.frames, row);
  }
  std::cout << trajectory << std::flush;
  if (!std::cout) throw std::runtime_error("standard output cannot be written");
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  try {
    ddm::Arguments arguments;
    if (ddm::parseArguments(argc, argv, &arguments)) ddm::simulate(arguments);
  } catch (const ddm::UsageError& e) {
    std::cerr << "simulate: " << e.what() << "\nsimulate --help lists the options\n";
    return ddm::kExitUsage;
  } catch (const std::exception& e) {
    std::cerr << "simulate: " << e.what() << '\n';
    return ddm::kExitData;
  }
  return EXIT_SUCCESS;
}
