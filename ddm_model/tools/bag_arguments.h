// Options of programs that read bags: what the block data_set says, on the command line.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/tool.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <string>

namespace ddm {

class BagArguments {
 public:
  void addTo(boost::program_options::options_description* options) {
    const auto add = [&](const char* option, const char* key, const char* form, const char* text) {
      options->add_options()(
          option,
          boost::program_options::value<std::string>()->value_name(form)->notifier(
              [this, key](const std::string& value) { given_[key] = value; }),
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

  /// Lays what was given over the blocks.
  void overlayOn(YAML::Node* blocks) const {
    for (const auto& entry : given_) {
      const bool is_list = entry.first == "motors" || entry.first == "crop";
      (*blocks)["data_set"][entry.first] =
          YAML::Load(is_list ? "[" + entry.second + "]" : entry.second);
    }
  }

 private:
  std::map<std::string, std::string> given_;  // by key
};

}  // namespace ddm
