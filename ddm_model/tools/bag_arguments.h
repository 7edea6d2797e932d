// Command line options for the parameters of block data_set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/tool.h>
#include <ddm_common/yaml_text.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// Adds the options. Their values are written to the block data_set of `given`, which the program
/// lays over the blocks of files.
/// @param given  must outlive the options
inline void addBagOptions(boost::program_options::options_description* options, YAML::Node* given) {
  const auto add = [&](const char* option, const std::string& key, const char* form,
                       const char* text) {
    const bool is_list = key == "motors" || key == "crop";
    const auto set = [given, key, is_list, name = std::string(option)](const std::string& value) {
      (*given)["data_set"][key] =
          parseYaml(is_list ? "[" + value + "]" : value, "option --" + name);
    };
    options->add_options()(
        option, boost::program_options::value<std::string>()->value_name(form)->notifier(set),
        text);
  };
  add("image-topic", "image_topic", "TOPIC",
      "data_set/image_topic: sensor_msgs/Image or CompressedImage, also without /compressed");
  add("torque-topic", "torque_topic", "TOPIC",
      "data_set/torque_topic: ddm_msgs/Torque, std_msgs/Float64, Float32 or arrays of them, "
      "geometry_msgs/WrenchStamped, sensor_msgs/JointState");
  add("dt", "dt", "S", "data_set/dt: time between frames [s], but for ddm_msgs/Torque");
  add("motors", "motors", "A,B,...",
      "data_set/motors: joints of a JointState, or parts (torque.z) of a wrench");
  add("crop", "crop", "X,Y,W,H",
      "data_set/crop: what counts of the images, column, row, width, height [pixels]");
}

}  // namespace ddm
