// Reads bags: images and torques on the wire to a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_files/plain_file.h>
#include <ddm_images/image_codec.h>
#include <ddm_params/option_checks.h>
#include <sensor_msgs/CompressedImage.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "bag_file.h"
#include "bag_message.h"
#include "torque_reader.h"
#include "trial_messages.h"

namespace ddm {
namespace {

/// "[1, 2]"
std::string listText(const std::vector<int>& numbers) {
  std::vector<std::string> texts;
  for (const int number : numbers) texts.push_back(std::to_string(number));
  return "[" + boost::algorithm::join(texts, ", ") + "]";
}

using Connections = std::map<std::uint32_t, BagConnection>;

std::string absolute(const std::string& topic) {
  return !topic.empty() && topic.front() == '/' ? topic : "/" + topic;
}

using Types = std::vector<std::string>;

/// A topic of a bag; an empty name: there is none.
struct Topic {
  std::string name;
  std::string type;
};

/// The recorded topic that `name` means: the one of this name, else one in some namespace.
Topic findTopic(const Connections& connections, const std::string& name, const Types& types,
                const std::string& key) {
  std::set<std::string> found;
  bool exact = false;
  for (const auto& entry : connections) {
    const bool is_exact = absolute(entry.second.topic) == absolute(name);
    if (!is_exact &&
        (exact || !boost::algorithm::ends_with(absolute(entry.second.topic), absolute(name))))
      continue;
    if (is_exact && !exact) found.clear();
    exact = is_exact;
    found.insert(entry.second.topic);
  }
  if (found.size() > 1) {
    throw std::runtime_error("topics " + *found.begin() + " and " + *found.rbegin() +
                             " both match: set data_set/" + key + " to one of them");
  }
  if (found.empty()) return {};
  Topic topic{*found.begin(), ""};
  for (const auto& entry : connections) {
    const BagConnection& connection = entry.second;
    if (connection.topic != topic.name) continue;
    if (std::find(types.begin(), types.end(), connection.type) == types.end()) {
      throw std::runtime_error("topic " + topic.name + " has type " + connection.type +
                               ", it must be " + boost::algorithm::join(types, " or ") +
                               ": set data_set/" + key);
    }
    if (!topic.type.empty() && topic.type != connection.type) {
      throw std::runtime_error("topic " + topic.name + " has messages of " + topic.type + " and " +
                               connection.type + ": leave this bag out");
    }
    topic.type = connection.type;
  }
  return topic;
}

Topic requireTopic(const Connections& connections, const std::string& name, const Types& types,
                   const std::string& key) {
  Topic topic = findTopic(connections, name, types, key);
  if (!topic.name.empty()) return topic;
  std::set<std::string> topics;
  for (const auto& entry : connections) {
    topics.insert(entry.second.topic);
  }
  throw std::runtime_error("no topic " + name + " (it holds: " +
                           (topics.empty() ? "nothing" : boost::algorithm::join(topics, " ")) +
                           "): record it, or set data_set/" + key);
}

const Types kImages = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};

/// Stamp of the header that images begin with.
ros::Time stampOf(const BagMessage& message) {
  MessageBytes bytes(message.bytes.data(), message.bytes.size());
  std_msgs::Header header;
  try {
    bytes.next(header);
  } catch (const std::exception& e) {
    throw std::runtime_error("a message of topic " + message.connection.topic + " " + e.what() +
                             ": leave this bag out");
  }
  return header.stamp;
}

/// An image and its encoding, as the camera sent it.
std::pair<sensor_msgs::Image, std::string> imageOf(const BagMessage& message) {
  if (message.connection.type == kImages[0]) {
    auto image = parse<sensor_msgs::Image>(message);
    std::string encoding = image.encoding;
    return {std::move(image), std::move(encoding)};
  }
  const auto compressed = parse<sensor_msgs::CompressedImage>(message);
  try {
    return {unpacked(compressed), compressed.format};
  } catch (const std::exception& e) {
    throw std::runtime_error("topic " + message.connection.topic + ": " + e.what());
  }
}

}  // namespace

std::vector<std::string> BagOptions::problems() const {
  OptionChecks data_set("data_set");
  const auto requireTopicName = [&data_set](const std::string& key, const std::string& topic) {
    data_set.require(!topic.empty() && topic.back() != '/', key, "be the name of a topic",
                     "'" + topic + "'");
  };
  requireTopicName("image_topic", image_topic);
  requireTopicName("torque_topic", torque_topic);
  requireTopicName("goal_topic", goal_topic);
  data_set.requireNotNegative("dt", dt);
  data_set.require(std::none_of(motors.begin(), motors.end(),
                                [](const std::string& motor) { return motor.empty(); }),
                   "motors", "be names", "an empty one");
  data_set.require(crop.size() == 4 && std::all_of(crop.begin(), crop.end(),
                                                   [](int n) { return n >= 0 && n <= 16384; }),
                   "crop", "be [column, row, width, height], each in [0, 16384]", listText(crop));
  return data_set.problems();
}

Grey greyOf(const sensor_msgs::Image& image, int image_size, const BagOptions& options) {
  const auto size = static_cast<std::uint32_t>(image_size);
  const bool done = image.width == size && image.height == size;  // its crop, too
  const std::vector<int>& crop = options.crop;
  return decodeImage(image, image_size,
                     done ? ImageCrop() : ImageCrop{crop[0], crop[1], crop[2], crop[3]});
}

BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options) {
  BagFile bag(in);
  const Topic images = requireTopic(bag.connections(), options.image_topic, kImages, "image_topic");
  const Topic torques =
      requireTopic(bag.connections(), options.torque_topic, TorqueReader::types(), "torque_topic");
  const Topic goal = findTopic(bag.connections(), options.goal_topic, kImages, "goal_topic");
  const bool by_stamp = TorqueReader::answersImages(torques.type);
  if (!by_stamp && options.dt == 0.0) {
    throw std::runtime_error("topic " + torques.name + " has type " + torques.type +
                             ", which does not say which image it answers: set data_set/dt, the "
                             "time between frames [s]");
  }
  const auto timeOf = [by_stamp](const BagMessage& image) {
    const ros::Time stamp = stampOf(image);
    return by_stamp || !stamp.isZero() ? stamp : image.recorded;
  };
  TrialMessages messages(image_size, options);
  TorqueReader reader(options.motors);
  std::set<std::string> publishers;
  bag.forEachMessage({images.name, torques.name}, [&](const BagMessage& message) {
    if (message.connection.topic == images.name) return messages.takeImageTime(timeOf(message));
    const std::optional<TimedTorque> torque = reader.read(message);
    if (!torque) return;
    messages.takeTorque(*torque);
    publishers.insert(message.connection.publisher);
  });
  if (publishers.empty()) {
    throw std::runtime_error(
        "topic " + torques.name + " has no torque" +
        (options.motors.empty() ? "" : " of " + boost::algorithm::join(options.motors, " and ")) +
        ": leave this bag out, or set data_set/torque_topic and motors");
  }
  if (publishers.size() > 1) {
    throw std::runtime_error("topic " + torques.name + " has torques of " +
                             boost::algorithm::join(publishers, " and ") +
                             ": record the one that moves the motor");
  }
  messages.pair(by_stamp ? 0.0 : options.dt);
  bag.forEachMessage({images.name, goal.name}, [&](const BagMessage& message) {
    if (message.connection.topic == goal.name) return messages.takeGoal(imageOf(message).first);
    const ros::Time time = timeOf(message);
    if (!messages.wants(time)) return;
    const auto image = imageOf(message);
    messages.takeImage(time, image.first, image.second);
  });
  return messages.frames();
}

BagContent readBag(const std::string& path, int image_size, const BagOptions& options) {
  if (boost::algorithm::ends_with(path, ".active")) {
    throw std::runtime_error(
        "bag " + path +
        ": its recording was not completed; `rosbag reindex` recovers what was "
        "written, then rename it to *.bag");
  }
  try {
    requirePlainFile(path);
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error(std::strerror(errno));
    return readBagBytes(&in, image_size, options);
  } catch (const std::exception& e) {
    throw std::runtime_error("bag " + path + ": " + e.what());
  }
}

}  // namespace ddm
