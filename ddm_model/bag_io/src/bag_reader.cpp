// Reads bags: images and torques on the wire to a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_files/plain_file.h>
#include <ddm_msgs/message_bytes.h>
#include <ddm_params/option_checks.h>

#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include "bag_file.h"
#include "trial_messages.h"

namespace ddm {
namespace {

using Connections = std::map<std::uint32_t, BagConnection>;

std::string absolute(const std::string& topic) {
  return !topic.empty() && topic.front() == '/' ? topic : "/" + topic;
}

/// The recorded topic that `name` means: the one of this name, else one in some namespace.
/// @return empty if there is none
std::string findTopic(const Connections& connections, const std::string& name,
                      const std::string& type, const std::string& key) {
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
  for (const auto& entry : connections) {
    if (found.count(entry.second.topic) > 0 && entry.second.type != type) {
      throw std::runtime_error("topic " + entry.second.topic + " has type " + entry.second.type +
                               ", it must be " + type + ": set data_set/" + key);
    }
  }
  return found.empty() ? "" : *found.begin();
}

std::string requireTopic(const Connections& connections, const std::string& name,
                         const std::string& type, const std::string& key) {
  const std::string topic = findTopic(connections, name, type, key);
  if (!topic.empty()) return topic;
  std::set<std::string> topics;
  for (const auto& entry : connections) {
    topics.insert(entry.second.topic);
  }
  throw std::runtime_error("no topic " + name + " (it holds: " +
                           (topics.empty() ? "nothing" : boost::algorithm::join(topics, " ")) +
                           "): record it, or set data_set/" + key);
}

template <class Message>
Message messageOf(const BagConnection& connection, const std::string& bytes) {
  if (connection.md5sum != ros::message_traits::md5sum<Message>()) {
    throw std::runtime_error("topic " + connection.topic +
                             " was recorded with another definition of " + connection.type);
  }
  try {
    return messageFromBytes<Message>(bytes.data(), bytes.size());
  } catch (const std::exception& e) {
    throw std::runtime_error("a message of topic " + connection.topic + " " + e.what() +
                             ": leave this bag out");
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
  return data_set.problems();
}

BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options) {
  BagFile bag(in);
  const std::string image_topic =
      requireTopic(bag.connections(), options.image_topic, "sensor_msgs/Image", "image_topic");
  const std::string torque_topic =
      requireTopic(bag.connections(), options.torque_topic, "ddm_msgs/Torque", "torque_topic");
  const std::string goal_topic =
      findTopic(bag.connections(), options.goal_topic, "sensor_msgs/Image", "goal_topic");
  TrialMessages messages(image_size);
  bag.forEachMessage([&](const BagConnection& connection, const std::string& bytes) {
    if (connection.topic == image_topic) {
      messages.takeImage(messageOf<sensor_msgs::Image>(connection, bytes));
    } else if (connection.topic == torque_topic) {
      messages.takeTorque(messageOf<ddm_msgs::Torque>(connection, bytes));
    } else if (connection.topic == goal_topic) {
      messages.takeGoal(messageOf<sensor_msgs::Image>(connection, bytes));
    }
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
