// Command line of the programs that read bags.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/config_blocks.h>
#include <ddm_common/tool.h>
#include <ddm_common/yaml_text.h>
#include <yaml-cpp/yaml.h>

#include <boost/algorithm/string/join.hpp>
#include <string>
#include <vector>

namespace ddm {

/// Arguments that all these programs have.
struct BagArguments {
  std::vector<std::string> configs;
  std::string out;
  std::vector<std::string> bags;
  YAML::Node data_set;  ///< values of the options for single parameters

  /// @return names of the files, for messages
  std::string files() const { return boost::algorithm::join(configs, ", "); }
  /// @return blocks of the files, and over them the values of the options
  YAML::Node blocks() const {
    YAML::Node blocks(YAML::NodeType::Map);
    for (const std::string& file : configs) overlay(readBlocks(file), &blocks);
    overlay(data_set, &blocks);
    return blocks;
  }

  /// Reads the command line.
  /// @param options  further options of the program
  /// @return false if --help was given and has been printed
  bool parse(int argc, char** argv, boost::program_options::options_description options) {
    namespace po = boost::program_options;
    options.add_options()("out", po::value(&out)->required(), "file or folder to write");
    options.add_options()("config", po::value(&configs)->composing(),
                          "YAML file with blocks of parameters; repeatable, later files win");
    const auto add = [&](const std::string& option, const std::string& key, const char* text) {
      const bool is_list = key == "motors" || key == "crop";
      const auto set = [this, option, key, is_list](const std::string& value) {
        data_set["data_set"][key] = parseYaml(is_list ? "[" + value + "]" : value, "--" + option);
      };
      options.add_options()(option.c_str(), po::value<std::string>()->notifier(set), text);
    };
    add("image-topic", "image_topic", "data_set/image_topic, also without /compressed");
    add("torque-topic", "torque_topic",
        "data_set/torque_topic: ddm_msgs/Torque, std_msgs/Float64, Float32 or arrays of them, "
        "geometry_msgs/WrenchStamped, sensor_msgs/JointState");
    add("dt", "dt", "data_set/dt: time between frames [s], but for ddm_msgs/Torque");
    add("motors", "motors",
        "data_set/motors, as A,B,...: joints of a JointState, or parts (torque.z) of a wrench");
    add("crop", "crop",
        "data_set/crop, as X,Y,W,H: what counts of the images, column, row, width, height");
    return parseCommandLine(argc, argv, options,
                            Positional{"bag", po::value(&bags)->required(), -1});
  }
};

}  // namespace ddm
