// read_bags: writes the samples of bags as training reads them, for programs in Python.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_reader.h>
#include <ddm_common/param_reader.h>
#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ros/time.h>

#include <filesystem>
#include <iostream>
#include <string>

#include "bag_arguments.h"

namespace po = boost::program_options;

namespace {

constexpr int kMaxImageSize = 16384;  // limit of the image size of a model

/// @return false if --help was given and has been printed
bool parse(int argc, char** argv, ddm::BagArguments* arguments, int* image_size) {
  po::options_description options(
      "Writes the frames of bags, paired, cropped and resized as training reads them.\n\n"
      "usage: rosrun ddm_model read_bags --image-size N --out DIR [--config FILE]... BAG...\n\n"
      "Output: DIR/0, DIR/1, ...: a folder for each bag with bag.yaml and numbers without a "
      "header,\n"
      "        frame by frame: images (grey values, 8 bit), torques [N m] and times [s] "
      "(doubles).\n"
      "        Likewise the times images_without_torque and torques_without_image.\n"
      "        What to know about a bag is in the notes of bag.yaml and on standard error.\n\n"
      "options");
  options.add_options()("image-size", po::value(image_size)->required(),
                        "images are brought to this width and height [pixels]");
  if (!arguments->parse(argc, argv, options)) return false;
  if (*image_size < 1 || *image_size > kMaxImageSize) {
    throw po::error("--image-size must lie in [1, " + std::to_string(kMaxImageSize) + "], got " +
                    std::to_string(*image_size));
  }
  return true;
}

void writeBag(const ddm::BagContent& content, const std::string& folder) {
  std::filesystem::create_directories(folder);
  const auto write = [&folder](const char* name, const auto& values) {
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    ddm::writeFileAtomically(folder + "/" + name,
                             std::string(bytes, values.size() * sizeof(*values.data())));
  };
  const ddm::DataSet& data = content.data;
  write("images", data.pixels(0, data.numFrames()));
  write("torques", data.torques());
  write("times", content.times);
  write("images_without_torque", content.images_without_torque);
  write("torques_without_image", content.torques_without_image);
  YAML::Node bag;
  bag["camera"] = content.camera;
  bag["torque_dim"] = data.torqueDim();
  for (const ddm::Segment& segment : data.segments()) bag["segment_sizes"].push_back(segment.size);
  bag["interval_s"] = ddm::formatDouble(content.interval);
  bag["goal"] = data.hasGoal() ? 1 : 0;
  bag["notes"] = content.notes;
  ddm::writeFileAtomically(folder + "/bag.yaml", YAML::Dump(bag) + "\n");
}

void run(const ddm::BagArguments& arguments, int image_size) {
  ddm::ParamReader params(arguments.blocks(), arguments.files());
  const auto topics = params.read<ddm::BagOptions>("data_set");
  params.requireValid();
  ddm::DifferentBags different;
  for (std::size_t i = 0; i < arguments.bags.size(); ++i) {
    const std::string& bag = arguments.bags[i];
    const ddm::BagContent content = ddm::readBag(bag, image_size, topics);
    different.require(bag, content);
    for (const std::string& note : content.notes) {
      std::cerr << "warning: bag " << bag << ": " << note << "\n";
    }
    writeBag(content, arguments.out + "/" + std::to_string(i));
  }
}

}  // namespace

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::BagArguments arguments;
  int image_size = 0;
  return ddm::runTool(
      "read_bags", [&] { return parse(argc, argv, &arguments, &image_size); },
      [&] { run(arguments, image_size); });
}
