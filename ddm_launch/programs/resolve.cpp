// Role `resolve` of experiment_node: prints the configuration for a launch file.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/config_blocks.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <iostream>
#include <iterator>
#include <memory>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "configuration.h"
#include "resolution.h"

namespace ddm {
namespace {

namespace po = boost::program_options;
namespace fs = boost::filesystem;

constexpr char kAbout[] =
    "Prints the configuration that arguments and files make up, as YAML. The launch files set it\n"
    "as the parameter `configuration`, which all their nodes read. An option with an empty value\n"
    "counts as not given. Relative paths in arguments start at the current folder, those in a\n"
    "file at the folder of that file.\n\n"
    "usage: rosrun ddm_launch experiment_node resolve --preset paper --plant pendulum --config "
    "my.yaml";

struct Request {
  Arguments arguments;
  std::string print;
  std::string path;
};

/// Splits the text of a launch argument into paths of bags, which are separated by blanks. Quotes are
/// parsed only if the text as a whole is not a file and its words are not all files.
std::vector<std::string> splitBags(const std::string& text) {
  const auto exists = [](const std::string& bag) { return fs::exists(expandHome(bag)); };
  if (exists(text)) return {text};
  std::istringstream in(text);
  const std::istream_iterator<std::string> first(in), end;
  std::vector<std::string> bags(first, end);
  if (std::all_of(bags.begin(), bags.end(), exists)) return bags;
  bags.clear();
  static const std::regex kWord("'([^']*)'|\"([^\"]*)\"|(\\S+)");
  for (std::sregex_iterator word(text.begin(), text.end(), kWord), last; word != last; ++word) {
    bags.push_back((*word)[1].str() + (*word)[2].str() + (*word)[3].str());
  }
  return bags;
}

void setBags(const std::vector<std::string>& texts, Arguments* arguments) {
  std::vector<std::string> all;
  for (const std::string& text : texts) {
    for (const std::string& bag : splitBags(text)) all.push_back(expandHome(bag));
  }
  arguments->set("start/bags", all);
}

/// Sets the motor limits of a simulated robot to those of the plant that simulates it.
void setMotors(const std::string& plant, Arguments* arguments) {
  ParamReader reader = ParamReader::fromFiles({plantFile(plant)});
  const std::shared_ptr<const PlantPlugin> plugin = readPlant(&reader);
  reader.requireValid();
  const Eigen::VectorXd limits = makePlant(*plugin)->info().max_torque;
  arguments->set("robot/max_torque",
                 std::vector<double>(limits.data(), limits.data() + limits.size()));
}

/// The command line without options that have an empty value, because launch files pass an empty
/// value for each argument that the user did not give.
std::vector<char*> givenWords(int argc, char** argv) {
  const auto isOption = [](const std::string& word) { return word.rfind("--", 0) == 0; };
  std::vector<char*> given = {argv[0]};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::string next = i + 1 < argc ? argv[i + 1] : "";
    const bool lacks_value = isOption(word) && word != "--help" &&
                             word.find('=') == std::string::npos &&
                             (next.empty() || isOption(next));
    if (!word.empty() && !lacks_value) given.push_back(argv[i]);
  }
  return given;
}

/// @return false if --help was given and has been printed
bool configure(int argc, char** argv, Request* request) {
  using Text = std::string;
  using Texts = std::vector<std::string>;
  Arguments* const arguments = &request->arguments;
  po::options_description options = configurationOptions(kAbout, arguments);
  auto add = options.add_options();
  add("defaults", po::value(&arguments->defaults)->composing(),
      "as --config, but preset and plant win over it; for launch files");
  add("runs", given<Text>("experiment/runs", arguments), "folder of an experiment");
  add("model", given<Text>("start/model", arguments), "saved model that trial 0 explores with");
  add("bags", po::value<Texts>()->multitoken()->notifier([arguments](const Texts& texts) {
    setBags(texts, arguments);
  }),
      "bags that count as trials before trial 0; a word may name several, a blank between two");
  add("motors-of",
      po::value<Text>()->notifier([arguments](const Text& plant) { setMotors(plant, arguments); }),
      "plant whose motors the robot has: robot/max_torque is that of its file");
  add("print", po::value(&request->print), "BLOCK/KEY: print this value alone");
  add("path", po::value(&request->path), "print this path alone, absolute and without ~");
  std::vector<char*> words = givenWords(argc, argv);
  return parseCommandLine(static_cast<int>(words.size()), words.data(), options);
}

/// Makes a path absolute, because nodes run in another folder.
void makeAbsolute(YAML::Node path) {
  if (!path.IsDefined() || !path.IsScalar() || path.Scalar().empty()) return;
  path = fs::absolute(path.Scalar()).lexically_normal().string();
}

void run(const Request& request) {
  if (!request.path.empty()) {
    std::cout << fs::absolute(request.path).lexically_normal().string();
    return;
  }
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
  const YAML::Node plant = all.plant->block();  // its paths are absolute
  if (hasKey(blocks, "plant", "model") && plant["model"].IsDefined()) {
    blocks["plant"]["model"] = plant["model"];
  }
  if (all.robot) makeAbsolute(blocks["robot"]["goal_file"]);
  if (request.print.empty()) {
    std::cout << YAML::Dump(blocks) << "\n";
    return;
  }
  const std::string::size_type slash = request.print.find('/');
  std::cout << blocks[request.print.substr(0, slash)][request.print.substr(slash + 1)];
}

}  // namespace

int resolveConfiguration(int argc, char** argv) {
  Request request;
  return runTool(
      "resolve", [&] { return configure(argc, argv, &request); }, [&] { run(request); });
}

}  // namespace ddm
