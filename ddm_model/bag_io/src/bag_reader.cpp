// Reads the images and torques of a bag as a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/yaml_text.h>
#include <sensor_msgs/CompressedImage.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "bag_file.h"
#include "bag_texts.h"
#include "pairing.h"
#include "torque_reader.h"

namespace ddm {
namespace {

using boost::algorithm::ends_with;
using Names = std::vector<std::string>;

constexpr int kFewGreyValues = 64;  // of 256; a 14 bit image in a 16 bit message has so few
const Names kImages = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};

/// A topic of a bag. An empty name means that there is none.
struct Topic {
  std::string name;
  std::string type;
};

/// The topics that the reader uses.
struct BagTopics {
  Topic images, torques;
  Topic goal;  ///< may be missing
};

/// @return "/torque" for "torque"
std::string absolute(const std::string& topic) {
  return !topic.empty() && topic.front() == '/' ? topic : "/" + topic;
}

/// Whether images on the topic are sensor_msgs/Image, not CompressedImage.
bool isRaw(const BagConnection& connection) { return connection.type == kImages.front(); }

/// @param key  option that gives the name
/// @return     topic with an empty name if there is none
Topic findTopic(const BagFile& bag, const std::string& name, const Names& types,
                const std::string& key) {
  using Found = std::map<std::string, std::map<std::string, std::string>>;
  // Type, by base (topic without transport) and by topic.
  Found exact, in_namespace;
  for (const auto& entry : bag.connections()) {
    const BagConnection& connection = entry.second;
    const std::string topic = absolute(connection.topic);
    Names bases = {topic};
    if (&types == &kImages && !isRaw(connection)) {  // "/camera/image_raw" for ".../compressed"
      bases.push_back(absolute(topic.substr(0, topic.rfind('/'))));
    }
    for (const std::string& base : bases) {
      const bool is_exact = base == absolute(name);
      if (!is_exact && !ends_with(base, absolute(name))) continue;
      std::string& type = (is_exact ? exact : in_namespace)[base][connection.topic];
      if (!type.empty() && type != connection.type) {
        refuseBag("topic ", connection.topic, " has messages of ", type, " and ", connection.type,
                  ": leave this bag out");
      }
      type = connection.type;
    }
  }
  const Found& found = exact.empty() ? in_namespace : exact;
  if (found.empty()) return {};
  const auto& [base, topics] = *found.begin();
  if (found.size() > 1) {
    refuseBag("topics ", topics.begin()->first, " and ", found.rbegin()->second.begin()->first,
              " both match: set data_set/", key, " to one of them");
  }
  for (const auto& [topic, type] : topics) {  // a raw topic comes first
    const bool known = absolute(topic) == base || ends_with(topic, "/compressed");
    if (known && std::find(types.begin(), types.end(), type) != types.end()) return {topic, type};
  }
  refuseBag("topic ", topics.begin()->first, " has type ", topics.begin()->second, ", it must be ",
            boost::algorithm::join(types, " or "),
            &types == &kImages ? " of the transport raw or compressed: record that, convert the "
                                 "images with `rosrun image_transport republish`"
                               : ": record that",
            ", or set data_set/", key);
}

Topic requireTopic(const BagFile& bag, const std::string& name, const Names& types,
                   const std::string& key) {
  Topic topic = findTopic(bag, name, types, key);
  if (!topic.name.empty()) return topic;
  std::set<std::string> topics;
  for (const auto& entry : bag.connections()) {
    topics.insert(entry.second.topic + " (" + entry.second.type + ")");
  }
  refuseBag("no topic ", name,
            " (it holds: ", topics.empty() ? "nothing" : boost::algorithm::join(topics, ", "),
            "): record it, or set data_set/", key);
}

/// Messages of a topic by one publisher.
struct Published {
  ros::Time first, last;
  std::size_t number = 0;

  void add(const ros::Time& time) {
    first = number == 0 ? time : std::min(first, time);
    last = std::max(last, time);
    ++number;
  }
};
using Publishers = std::map<std::string, Published>;  // by name of the node

/// Checks that no two publishers published at the same time. Adds a note if several published, one
/// after the other. Ignores publishers without a name, which rosbag omits in some latched messages.
/// @param what    beginning of the message, before the publishers
/// @param remedy  remedy for two publishers at the same time
/// @throws std::runtime_error if two published at the same time
void requireOneAtATime(Publishers publishers, const std::string& what, const std::string& remedy,
                       Names* notes) {
  publishers.erase("");
  if (publishers.size() < 2) return;
  std::vector<std::pair<std::string, Published>> in_order(publishers.begin(), publishers.end());
  std::stable_sort(in_order.begin(), in_order.end(),
                   [](const auto& a, const auto& b) { return a.second.first < b.second.first; });
  bool overlap = false;
  ros::Time last;  // of the publishers so far
  Names texts;
  for (const auto& [name, published] : in_order) {
    texts.push_back(textOf(name, " (", published.number, " from ", timeText(published.first),
                           " to ", timeText(published.last), ")"));
    overlap = overlap || (texts.size() > 1 && published.first <= last);
    last = published.last;
  }
  const std::string text = what + boost::algorithm::join(texts, " and ");
  if (overlap) refuseBag(text, ": ", remedy);
  notes->push_back(text + ", one after the other: all of them count");
}

/// Reads the times of an image, and hashes its content without the header.
BagImage bagImageOf(const BagMessage& message, std::size_t number) {
  MessageBytes bytes(message.bytes.data(), message.bytes.size());
  std_msgs::Header header;
  try {
    bytes.next(header);
  } catch (const std::exception& e) {
    refuseMessage(message, e);
  }
  const std::string_view content = message.bytes.substr(message.bytes.size() - bytes.left());
  return {header.stamp, message.recorded, number, std::hash<std::string_view>()(content)};
}

/// Finds the topics that the options name: exactly, or else in some namespace. An image topic may
/// also be a compressed form.
/// @throws std::runtime_error that names the key and the remedy. Faults: there is no such topic, or
///         several; the type or the image transport cannot be read; a topic has two roles; torques
///         do not name their images, and dt is 0
BagTopics findTopics(const BagFile& bag, const BagOptions& options) {
  BagTopics topics;
  topics.images = requireTopic(bag, options.image_topic, kImages, "image_topic");
  topics.torques = requireTopic(bag, options.torque_topic, torqueTypes(), "torque_topic");
  topics.goal = findTopic(bag, options.goal_topic, kImages, "goal_topic");
  if (!answersImages(topics.torques.type) && options.dt == 0.0) {
    refuseBag(
        "topic ", topics.torques.name, " has type ", topics.torques.type,
        ", which does not say which image it answers: set data_set/dt, the time between frames "
        "[s]");
  }
  if (topics.goal.name == topics.images.name) {
    refuseBag(
        "topic ", topics.goal.name,
        " is meant by data_set/image_topic and data_set/goal_topic: set one of them to another "
        "topic");
  }
  return topics;
}

/// Reads the times of all images and torques, and pairs them. Pixels are not decoded, since many
/// images of a fast camera belong to no sample.
/// @throws std::runtime_error like findTopics() and pairUp(); also if there is no torque, or if two
///         nodes publish torques or images at the same time
Pairs readPairs(BagFile* bag, const BagTopics& topics, const BagOptions& options) {
  TorqueReader reader(options.motors);
  Publishers controllers, cameras;
  std::vector<BagImage> images;
  std::vector<BagTorque> torques;
  bag->forEachMessage({topics.images.name, topics.torques.name}, [&](const BagMessage& message) {
    if (message.connection.topic == topics.images.name) {
      cameras[message.connection.publisher].add(message.recorded);
      images.push_back(bagImageOf(message, images.size()));
    } else if (const std::optional<BagTorque> torque = reader.read(message)) {
      controllers[message.connection.publisher].add(message.recorded);
      torques.push_back(*torque);
    }
  });
  const std::string& topic = topics.torques.name;
  const std::string unknown = reader.withoutEffort();
  if (torques.empty()) {
    const std::string motors = boost::algorithm::join(options.motors, " and ");
    refuseBag("topic ", topic, " has no torque", motors.empty() ? "" : " of " + motors,
              unknown.empty() ? "" : " (" + unknown + " have no effort or number of them)",
              ": leave this bag out, or set data_set/torque_topic and motors");
  }
  Names notes;
  if (!unknown.empty()) {
    notes.push_back("topic " + topic + ": " + unknown +
                    " have no effort or number of the motors and do not count");
  }
  requireOneAtATime(controllers, "topic " + topic + " has torques of ",
                    "record the one that moves the motor", &notes);
  requireOneAtATime(cameras, "topic " + topics.images.name + " has images of ",
                    "record each camera on a topic of its own", &notes);
  const bool by_stamp = answersImages(topics.torques.type);
  Pairs pairs = pairUp(std::move(images), std::move(torques), by_stamp ? 0.0 : options.dt);
  pairs.notes.insert(pairs.notes.begin(), notes.begin(), notes.end());
  return pairs;
}

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

/// @return hash of time, image and torque of a sample
std::size_t idOf(const Image& grey, const Pairs::Frame& frame) {
  std::string bytes(grey.begin(), grey.end());
  bytes.append(reinterpret_cast<const char*>(frame.torque.data()),
               frame.torque.size() * sizeof(double));
  return std::hash<std::string>()(bytes + timeText(frame.time));
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
    if (pairs.of_others) content.frame_ids.push_back(idOf(grey, frame));
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

BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options) {
  BagFile bag(in);
  const BagTopics topics = findTopics(bag, options);
  const Pairs pairs = readPairs(&bag, topics, options);
  return contentOf(pairs, decodeImages(&bag, topics, pairs, image_size, options), image_size);
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
    std::ifstream in(path, std::ios::binary);
    if (!in) refuseBag(std::strerror(errno));
    return readBagBytes(&in, image_size, options);
  } catch (const std::exception& e) {
    refuseBag("bag ", path, ": ", e.what());
  }
}

}  // namespace ddm
