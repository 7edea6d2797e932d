// Topics of a bag: selects them, and pairs their torques with the images.
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_topics.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "bag_texts.h"
#include "torque_reader.h"

namespace ddm {
namespace {

using boost::algorithm::ends_with;
using Names = std::vector<std::string>;

const Names kImages = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};

/// @return "/camera/image_raw" for "camera/image_raw/compressed"
std::string parentOf(const std::string& topic) {
  return absolute(topic.substr(0, topic.rfind('/')));
}

/// @param key  option that gives the name
/// @return     topic with an empty name if there is none
Topic findTopic(const BagFile& bag, const std::string& name, const Names& types,
                const std::string& key) {
  using Found = std::map<std::string, std::map<std::string, std::string>>;
  // Type, by base (topic without transport) and by topic.
  Found exact, in_namespace;
  for (const auto& entry : bag.connections()) {
    const BagConnection& connection = entry.second;
    std::vector<std::string> bases = {absolute(connection.topic)};
    if (&types == &kImages && !isRaw(connection)) bases.push_back(parentOf(connection.topic));
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

constexpr double kPause = 3.0;  // shortest time without messages / median interval

/// Times of the messages of a topic, by name of the node that published them.
using Publishers = std::map<std::string, std::vector<ros::Time>>;

/// Whether a publisher published while another one was publishing, i.e. not in a pause of it.
/// @param times, others  of both, sorted
bool isAmong(const std::vector<ros::Time>& times, const std::vector<ros::Time>& others) {
  const double pause = kPause * medianInterval(others);
  return std::any_of(times.begin(), times.end(), [&](const ros::Time& time) {
    const auto next = std::upper_bound(others.begin(), others.end(), time);
    return next != others.begin() && next != others.end() &&
           secondsBetween(*std::prev(next), *next) < pause;
  });
}

/// Checks that no two publishers published at the same time. Adds a note if several published, one
/// after the other or in turns. Ignores publishers without a name, which rosbag omits in some
/// latched messages.
/// @param what    beginning of the message, before the publishers
/// @param remedy  remedy for two publishers at the same time
/// @throws std::runtime_error if two published at the same time
void requireOneAtATime(Publishers publishers, const std::string& what, const std::string& remedy,
                       Names* notes) {
  publishers.erase("");
  if (publishers.size() < 2) return;
  for (auto& publisher : publishers) {
    std::sort(publisher.second.begin(), publisher.second.end());
  }
  bool overlap = false;
  Names texts;
  for (const auto& [name, times] : publishers) {
    texts.push_back(textOf(name, " (", times.size(), " from ", timeText(times.front()), " to ",
                           timeText(times.back()), ")"));
    for (const auto& [other, others] : publishers) {
      overlap = overlap || (other != name && isAmong(times, others));
    }
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

}  // namespace

std::string absolute(const std::string& topic) {
  return !topic.empty() && topic.front() == '/' ? topic : "/" + topic;
}

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

bool isRaw(const BagConnection& connection) { return connection.type == kImages.front(); }

Pairs readPairs(BagFile* bag, const BagTopics& topics, const BagOptions& options) {
  TorqueReader reader(options.motors);
  Publishers controllers, cameras;
  std::vector<BagImage> images;
  std::vector<BagTorque> torques;
  bag->forEachMessage({topics.images.name, topics.torques.name}, [&](const BagMessage& message) {
    if (message.connection.topic == topics.images.name) {
      cameras[message.connection.publisher].push_back(message.recorded);
      images.push_back(bagImageOf(message, images.size()));
    } else if (const std::optional<BagTorque> torque = reader.read(message)) {
      controllers[message.connection.publisher].push_back(message.recorded);
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
  if (bag->bytesBehindIndex() > 0) {
    notes.push_back(textOf(bag->bytesBehindIndex(),
                           " bytes behind its index are not read, such as a second bag that was "
                           "appended: give each bag as a file of its own"));
  }
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

}  // namespace ddm
