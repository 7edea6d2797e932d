// Reads the images and torques of a bag as a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/yaml_text.h>
#include <sensor_msgs/CompressedImage.h>
#include <sys/stat.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <filesystem>
#include <map>
#include <utility>

#include "bag_file.h"
#include "bag_texts.h"
#include "bag_topics.h"
#include "pairing.h"

namespace ddm {
namespace {

constexpr int kFewGreyValues = 64;  // of 256; a 14 bit image in a 16 bit message has so few

/// Parses a raw or compressed image.
/// @param encoding  out: encoding or format as the camera sent it
/// @throws std::invalid_argument if a compressed image cannot be decoded
sensor_msgs::Image imageOf(const BagMessage& message, std::string* encoding) {
  if (isRaw(message.connection)) {
    auto image = parse<sensor_msgs::Image>(message);
    *encoding = image.encoding;
    return image;
  }
  const auto compressed = parse<sensor_msgs::CompressedImage>(message);
  *encoding = compressed.format;
  return unpacked(compressed);
}

/// The decoded images of a bag.
struct BagImages {
  std::vector<Image> greys;         ///< of the samples; empty: the image cannot be decoded
  Image goal;                       ///< empty: there is no goal image
  std::string camera;               ///< see BagContent
  std::vector<std::string> faults;  ///< of the images that cannot be decoded
};

/// Decodes the images of the samples, and the goal image.
/// @throws std::runtime_error if the camera changes, or if the goal image cannot be decoded
BagImages decodeImages(BagFile* bag, const BagTopics& topics, const Pairs& pairs, int image_size,
                       const BagOptions& options) {
  BagImages out;
  out.greys.resize(pairs.frames.size());
  std::map<std::size_t, std::size_t> frame_of;  // index of the sample, by number of the image
  for (std::size_t i = 0; i < pairs.frames.size(); ++i) frame_of[pairs.frames[i].image] = i;
  std::size_t number = 0;  // of the next image in the order of the file
  bag->forEachMessage({topics.images.name, topics.goal.name}, [&](const BagMessage& message) {
    std::string encoding;
    if (message.connection.topic == topics.goal.name) {
      try {
        out.goal = greyOf(imageOf(message, &encoding), image_size, options);
      } catch (const std::exception& e) {
        refuseBag("goal image on ", topics.goal.name, ": ", e.what());
      }
      return;
    }
    const auto frame = frame_of.find(number++);
    if (frame == frame_of.end()) return;
    const std::string time = timeText(pairs.frames[frame->second].time);
    try {
      const sensor_msgs::Image image = imageOf(message, &encoding);
      if (image.data.empty()) throw std::invalid_argument("it has no pixels");
      const std::string size = textOf(image.width, "x", image.height, " ");
      if (out.camera.empty()) out.camera = size + encoding;
      // The format of a compressed image may change without a change of its pixels.
      if (isRaw(message.connection) ? out.camera != size + encoding
                                    : !boost::algorithm::starts_with(out.camera, size)) {
        refuseBag("the images change from ", out.camera, " to ", size, encoding, " at ", time,
                  ": record one camera setting per bag");
      }
      out.greys[frame->second] = greyOf(image, image_size, options);
    } catch (const std::invalid_argument& e) {
      out.faults.push_back("image at " + time + ": " + e.what());
    }
  });
  return out;
}

/// @return all samples, with notes to the user
/// @throws std::runtime_error if more images are broken than whole
BagContent contentOf(const Pairs& pairs, const BagImages& images, int image_size) {
  if (2 * images.faults.size() > images.greys.size()) refuseBag(images.faults.front());
  const auto torque_dim = static_cast<Eigen::Index>(pairs.frames.front().torque.size());
  BagContent content{DataSet(image_size, static_cast<int>(torque_dim)), images.camera};
  std::vector<ros::Time> times;
  bool new_segment = false;
  int darkest = 255, brightest = 0;
  for (std::size_t i = 0; i < images.greys.size(); ++i) {
    const Pairs::Frame& frame = pairs.frames[i];
    const Image& grey = images.greys[i];
    new_segment = new_segment || frame.new_segment || grey.empty();
    if (grey.empty()) continue;
    const auto range = std::minmax_element(grey.begin(), grey.end());
    darkest = std::min<int>(darkest, *range.first);
    brightest = std::max<int>(brightest, *range.second);
    times.push_back(frame.time);
    content.data.append(grey, Eigen::Map<const Eigen::VectorXd>(frame.torque.data(), torque_dim),
                        new_segment);
    new_segment = false;
  }
  if (!images.goal.empty()) content.data.setGoal(images.goal);
  const auto sinceFirst = [&times](const std::vector<ros::Time>& all, double lag) {
    std::vector<double> seconds;
    for (const ros::Time& time : all) seconds.push_back(secondsBetween(times.front(), time) - lag);
    return seconds;
  };
  content.times = sinceFirst(times, 0.0);
  content.interval = medianInterval(times);
  content.images_without_torque = sinceFirst(pairs.images_without_torque, 0.0);
  content.torques_without_image = sinceFirst(pairs.torques_without_image, pairs.lag);
  if (pairs.of_others) content.ids = pairs.ids;
  content.notes = pairs.notes;
  if (pairs.of_others && content.data.torques().isZero(0.0)) {
    content.notes.emplace_back("all its torques are 0: record what commands the motors");
  }
  if (!images.faults.empty()) {
    content.notes.push_back(
        textOf(images.faults.size(),
               " image(s) cannot be read and leave a gap, the first: ", images.faults.front()));
  }
  if (brightest - darkest < kFewGreyValues) {
    content.notes.push_back(textOf(
        "its images (", images.camera, ") have grey values from ", darkest, " to ", brightest,
        " of 255, so that little can be told apart: scale 10 or 12 bits, or a depth, to the "
        "whole range before they are recorded"));
  }
  return content;
}

}  // namespace

std::vector<std::string> BagOptions::problems() const {
  OptionChecks data_set("data_set");
  const std::map<std::string, std::string> names = {
      {"image_topic", image_topic}, {"torque_topic", torque_topic}, {"goal_topic", goal_topic}};
  for (const auto& [key, topic] : names) {
    data_set.require(!topic.empty() && topic.back() != '/', key, "be the name of a topic",
                     "'" + topic + "'");
    for (const auto& [other_key, other] : names) {
      data_set.require(key <= other_key || absolute(topic) != absolute(other), key,
                       "be another topic than data_set/" + other_key, "'" + topic + "' for both");
    }
  }
  data_set.requireNotNegative("dt", dt);
  data_set.require(std::none_of(motors.begin(), motors.end(),
                                [](const std::string& motor) { return motor.empty(); }),
                   "motors", "be names", "an empty one");
  data_set.require(
      crop.size() == 4 &&
          std::all_of(crop.begin(), crop.end(), [](int n) { return n >= 0 && n <= 16384; }),
      "crop", "be [column, row, width, height], each in [0, 16384]", oneLine(valueToYaml(crop)));
  return data_set.problems();
}

Image greyOf(const sensor_msgs::Image& image, int image_size, const BagOptions& options) {
  const auto size = static_cast<std::uint32_t>(image_size);
  const bool done = image.width == size && image.height == size;  // and needs no crop
  const std::vector<int>& crop = options.crop;
  return decodeImage(image, image_size,
                     done ? ImageCrop() : ImageCrop{crop[0], crop[1], crop[2], crop[3]});
}

BagContent readBag(const std::string& path, int image_size, const BagOptions& options) {
  namespace fs = std::filesystem;
  try {
    if (boost::algorithm::ends_with(path, ".active")) {
      refuseBag(
          "its recording was not completed; `rosbag reindex` recovers what was written, then "
          "rename it to *.bag");
    }
    if (fs::exists(path + "/metadata.yaml")) {
      refuseBag(
          "is the folder of a recording of ROS 2; only bags of format 2.0 (ROS 1) are read: "
          "convert it with `rosbags-convert --src FOLDER --dst FILE.bag` (pip install rosbags)");
    }
    if (fs::is_directory(path)) refuseBag("is a folder: name the bags in it");
    requirePlainFile(path);
    BagFile bag(path);
    const BagTopics topics = findTopics(bag, options);
    const Pairs pairs = readPairs(&bag, topics, options);
    return contentOf(pairs, decodeImages(&bag, topics, pairs, image_size, options), image_size);
  } catch (const std::exception& e) {
    refuseBag("bag ", path, ": ", e.what());
  }
}

void DifferentBags::require(const std::string& path, const BagContent& content) {
  constexpr char kRemedy[] = ": it would count twice, so leave one of them out";
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    const auto added = files_.emplace(std::make_pair(status.st_dev, status.st_ino), path);
    const std::string& before = added.first->second;
    if (!added.second) {
      refuseBag("bag ", path, " is given twice", before == path ? "" : ", also as " + before,
                kRemedy);
    }
  }
  std::map<std::string, std::size_t> shared;  // number of images in both, by path of the other bag
  for (const std::size_t id : content.ids) {
    const auto added = images_.emplace(id, path);
    if (!added.second && added.first->second != path) ++shared[added.first->second];
  }
  const std::size_t all = content.ids.size();
  num_images_[path] = all;
  for (const auto& [other, number] : shared) {
    const std::size_t smaller = std::min(all, num_images_.at(other));
    if (10 * number <= smaller) continue;
    refuseBag("bag ", path, ": ", number, " of its ", all, " images are also among the ",
              num_images_.at(other), " of bag ", other, ", with the same times", kRemedy,
              ", or split the recording without an overlap");
  }
}

}  // namespace ddm
