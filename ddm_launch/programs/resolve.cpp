// resolve: the configuration of a launch as one text, from the arguments of the launch.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_params/config_blocks.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant_factory.h>

#include <boost/filesystem.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "resolution.h"

namespace ddm {
namespace {

namespace po = boost::program_options;

constexpr char kAbout[] =
    "Prints the configuration that arguments and files make up, as YAML. The launch files set it "
    "as\n"
    "the parameter `configuration`, which all their nodes read. An option with an empty value\n"
    "counts as not given. Relative paths start at the current folder.\n\n"
    "usage: rosrun ddm_launch resolve --preset paper --plant pendulum --config my.yaml\n\noptions";

struct Request {
  Arguments arguments;
  std::vector<std::string> access;
  std::string print;
};

/// BLOCK/KEY=VALUE
void setValue(const std::string& text, Arguments* arguments) {
  const std::string::size_type equals = text.find('=');
  const std::string::size_type slash = text.find('/');
  if (equals == std::string::npos || slash == std::string::npos || slash > equals) {
    throw po::error("--set must be BLOCK/KEY=VALUE, got '" + text + "'");
  }
  const std::string key = text.substr(slash + 1, equals - slash - 1);
  const std::string value = text.substr(equals + 1);
  if (!value.empty()) arguments->values[text.substr(0, slash)][key] = value;
}

/// X,Y,WIDTH,HEIGHT of a robot's camera.
void setCrop(const std::string& text, Arguments* arguments) {
  int crop[4];
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d,%d,%d%c", &crop[0], &crop[1], &crop[2], &crop[3], &rest) !=
      4) {
    throw po::error("--crop must be X,Y,WIDTH,HEIGHT in whole pixels, got '" + text + "'");
  }
  arguments->set("robot/crop_x", crop[0]);
  arguments->set("robot/crop_y", crop[1]);
  arguments->set("robot/crop_width", crop[2]);
  arguments->set("robot/crop_height", crop[3]);
}

/// The robot is a stand-in: this plant, simulated.
void setMotors(const std::string& plant, Arguments* arguments) {
  ParamReader reader = ParamReader::fromFiles({plantFile(plant)});
  const std::shared_ptr<const PlantPlugin> plugin = readPlant(&reader);
  reader.requireValid();
  const Eigen::VectorXd limits = makePlant(*plugin)->info().max_torque;
  arguments->values["robot"]["max_torque"] =
      limits.size() == 1
          ? valueToYaml(limits[0])
          : valueToYaml(std::vector<double>(limits.data(), limits.data() + limits.size()));
}

/// Command line without the options that have an empty value: launch files pass an argument that
/// was not given like that.
std::vector<std::string> givenWords(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  std::vector<std::string> given;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool option = words[i].rfind("--", 0) == 0 && words[i] != "--help";
    const bool empty =
        i + 1 == words.size() || words[i + 1].empty() || words[i + 1].rfind("--", 0) == 0;
    if (words[i].empty() || (option && empty)) continue;
    given.push_back(words[i]);
  }
  return given;
}

/// @return false where --help was asked for and has been printed
bool configure(int argc, char** argv, Request* request) {
  Arguments* const arguments = &request->arguments;
  const auto text = [arguments](const std::string& key) {
    return po::value<std::string>()->notifier(
        [=](const std::string& value) { arguments->set(key, value); });
  };
  po::options_description options(kAbout);
  auto add = options.add_options();
  add("preset", text("experiment/preset"), "name in ddm_launch/config/presets");
  add("plant", text("experiment/plant"), "name in ddm_sim/config, or PACKAGE/NAME");
  add("nuisance", po::value(&arguments->nuisances)->composing(),
      "name in ddm_launch/config/nuisances; repeatable");
  add("config", po::value(&arguments->configs)->composing(),
      "YAML file with overrides; repeatable, later files win");
  add("runs", text("experiment/runs"), "folder of an experiment");
  add("model", text("start/model"), "saved model that trial 0 explores with");
  add("bags",
      po::value<std::vector<std::string>>()->multitoken()->notifier(
          [=](const std::vector<std::string>& bags) { arguments->set("start/bags", bags); }),
      "bags that count as trials before trial 0");
  add("crop", po::value<std::string>()->notifier([=](const std::string& crop) {
    setCrop(crop, arguments);
  }),
      "X,Y,WIDTH,HEIGHT: the part of a robot's camera image that counts");
  add("motors-of", po::value<std::string>()->notifier([=](const std::string& plant) {
    setMotors(plant, arguments);
  }),
      "plant whose motors the robot has: robot/max_torque is that of its file");
  add("set",
      po::value<std::vector<std::string>>()->composing()->notifier(
          [=](const std::vector<std::string>& all) {
            for (const std::string& one : all) setValue(one, arguments);
          }),
      "BLOCK/KEY=VALUE, wins over all files; repeatable");
  add("access", po::value(&request->access)->multitoken(),
      "folders and bags that requests to the nodes may name, with those of the experiment");
  add("print", po::value(&request->print), "BLOCK/KEY: print this value alone");
  const std::vector<std::string> given = givenWords(argc, argv);
  std::vector<char*> words = {argv[0]};
  for (const std::string& word : given) words.push_back(const_cast<char*>(word.c_str()));
  return parseCommandLine(static_cast<int>(words.size()), words.data(), options);
}

/// Nodes run in another folder.
void makeAbsolute(YAML::Node path) {
  if (!path.IsDefined() || !path.IsScalar() || path.Scalar().empty()) return;
  path = boost::filesystem::absolute(path.Scalar()).lexically_normal().string();
}

/// Adds to what requests to the nodes may name; the default, the folder in which a node runs, goes.
void allowAccess(const std::vector<std::string>& paths, YAML::Node* blocks) {
  YAML::Node bags(YAML::NodeType::Sequence);
  for (const std::string& path : paths) bags.push_back(path);
  for (const YAML::Node& bag : (*blocks)["access"]["bags"]) {
    if (bag.Scalar() != ".") bags.push_back(bag.Scalar());
  }
  (*blocks)["access"]["bags"] = bags;
}

void run(const Request& request) {
  ResolvedConfiguration resolved = resolve(request.arguments);
  ParamReader reader = resolved.reader();
  const Configuration all = readEachBlock(&reader);
  const YAML::Node names = request.arguments.values["experiment"];
  const bool experiment = names.IsDefined() && names["runs"].IsDefined();
  if (experiment) requireConsistent(all);

  YAML::Node& blocks = resolved.blocks;
  makeAbsolute(blocks["experiment"]["runs"]);
  makeAbsolute(blocks["start"]["model"]);
  for (YAML::Node bag : blocks["start"]["bags"]) makeAbsolute(bag);
  if (all.robot) makeAbsolute(blocks["robot"]["goal_file"]);
  std::vector<std::string> access = request.access;
  if (experiment) access.push_back(blocks["experiment"]["runs"].Scalar());
  for (const YAML::Node& bag : blocks["start"]["bags"]) access.push_back(bag.Scalar());
  if (!access.empty()) allowAccess(access, &blocks);
  if (request.print.empty()) {
    std::cout << YAML::Dump(blocks) << "\n";
    return;
  }
  const std::string::size_type slash = request.print.find('/');
  std::cout << blocks[request.print.substr(0, slash)][request.print.substr(slash + 1)] << "\n";
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::Request request;
  return ddm::runTool(
      "resolve", [&] { return ddm::configure(argc, argv, &request); }, [&] { ddm::run(request); });
}
