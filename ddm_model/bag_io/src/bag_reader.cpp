// Reads bags: images and torques on the wire to a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/plain_file.h>
#include <sensor_msgs/CompressedImage.h>
#include <sys/stat.h>

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
#include <stdexcept>
#include <string_view>
#include <utility>

#include "bag_file.h"
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

constexpr char kCompressed[] = "/compressed";  // of image_transport

/// The topic that image_transport made this one of.
std::string baseOf(const std::string& topic) {
  return boost::algorithm::ends_with(topic, kCompressed)
             ? topic.substr(0, topic.size() - (sizeof(kCompressed) - 1))
             : topic;
}

[[noreturn]] void refuseTransport(const Topic& topic) {
  const std::size_t slash = topic.name.rfind('/');
  const std::string base = absolute(topic.name.substr(0, slash));
  const std::string transport = topic.name.substr(slash + 1);
  throw std::runtime_error("topic " + topic.name + " has images of the transport " + transport +
                           " (" + topic.type + "), which cannot be read: record " + base + " or " +
                           base +
                           "/compressed, or play the bag with `rosrun image_transport republish " +
                           transport + " in:=" + base + " raw out:=/image_raw` and record that");
}

/// The recorded topic that `name` means: the one of this name, else one in some namespace; of an
/// image, that name or its compressed form.
Topic findTopic(const Connections& connections, const std::string& name, const Types& types,
                const std::string& key) {
  std::map<std::string, std::set<std::string>> found;  // by the name without transport
  bool exact = false;
  for (const auto& entry : connections) {
    const std::string& topic = entry.second.topic;
    for (const std::string& base : {topic, baseOf(topic)}) {
      const bool is_exact = absolute(base) == absolute(name);
      if (!is_exact && (exact || !boost::algorithm::ends_with(absolute(base), absolute(name)))) {
        continue;
      }
      if (is_exact && !exact) found.clear();
      exact = is_exact;
      found[base].insert(topic);
    }
  }
  if (found.size() > 1) {
    throw std::runtime_error("topics " + *found.begin()->second.begin() + " and " +
                             *found.rbegin()->second.begin() + " both match: set data_set/" + key +
                             " to one of them");
  }
  if (found.empty()) return {};
  Topic topic{*found.begin()->second.begin(), ""};  // the raw one sorts first
  for (const auto& entry : connections) {
    const BagConnection& connection = entry.second;
    if (connection.topic != topic.name) continue;
    for (const char* transport : {"/theora", "/compressedDepth"}) {
      if (key == "image_topic" && boost::algorithm::ends_with(topic.name, transport)) {
        refuseTransport({topic.name, connection.type});
      }
    }
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
    const std::string& other = entry.second.topic;
    topics.insert(other + " (" + entry.second.type + ")");
    const std::string base = absolute(other.substr(0, other.rfind('/')));
    if (key == "image_topic" && boost::algorithm::ends_with(base, absolute(name))) {
      refuseTransport({other, entry.second.type});
    }
  }
  throw std::runtime_error("no topic " + name + " (it holds: " +
                           (topics.empty() ? "nothing" : boost::algorithm::join(topics, ", ")) +
                           "): record it, or set data_set/" + key);
}

const Types kImages = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};

/// Tells the stamp of an image, and what is the same in images with the same content.
void takeTimeOf(const BagMessage& message, TrialMessages* messages) {
  MessageBytes bytes(message.bytes.data(), message.bytes.size());
  std_msgs::Header header;
  try {
    bytes.next(header);
  } catch (const std::exception& e) {
    throw std::runtime_error("the message of topic " + message.connection.topic + " recorded at " +
                             std::to_string(message.recorded.toSec()) + " s " + e.what() +
                             ": leave this bag out");
  }
  const std::string_view content(message.bytes.data() + message.bytes.size() - bytes.left(),
                                 bytes.left());
  messages->takeImageTime(header.stamp, message.recorded, std::hash<std::string_view>()(content));
}

void takeImage(const BagMessage& message, std::size_t number, TrialMessages* messages) {
  if (message.connection.type == kImages[0]) {
    const auto image = parse<sensor_msgs::Image>(message);
    return messages->takeImage(number, image, image.encoding);
  }
  const auto compressed = parse<sensor_msgs::CompressedImage>(message);
  sensor_msgs::Image image;
  try {
    image = unpacked(compressed);
  } catch (const std::invalid_argument& e) {
    return messages->takeBrokenImage(number, e.what());
  }
  messages->takeImage(number, image, compressed.format);
}

void takeGoal(const BagMessage& message, TrialMessages* messages) {
  const bool raw = message.connection.type == kImages[0];
  try {
    messages->takeGoal(raw ? parse<sensor_msgs::Image>(message)
                           : unpacked(parse<sensor_msgs::CompressedImage>(message)));
  } catch (const std::exception& e) {
    throw std::runtime_error("goal image on " + message.connection.topic + ": " + e.what());
  }
}

/// Who published on a topic, and when.
class Publishers {
 public:
  void take(const std::string& name, const ros::Time& time) {
    Span& span = spans_.try_emplace(name, Span{time, time, 0}).first->second;
    span.first = std::min(span.first, time);
    span.last = std::max(span.last, time);
    ++span.number;
  }
  bool empty() const { return spans_.empty(); }

  /// A publisher without a name is not known to be another one: rosbag leaves it out in some
  /// latched messages.
  /// @return a note if there are several, one after the other; else empty
  /// @throws std::runtime_error if two published at the same time
  /// @param remedy  for two at the same time
  std::string requireOneAtATime(const std::string& what, const std::string& remedy) const {
    std::vector<std::pair<std::string, Span>> named;
    std::vector<std::string> texts;
    for (const auto& entry : spans_) {
      if (!entry.first.empty()) named.push_back(entry);
    }
    std::sort(named.begin(), named.end(),
              [](const auto& a, const auto& b) { return a.second.first < b.second.first; });
    bool overlap = false;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const Span& span = named[i].second;
      texts.push_back(named[i].first + " (" + std::to_string(span.number) + " from " +
                      std::to_string(span.first.toSec()) + " s to " +
                      std::to_string(span.last.toSec()) + " s)");
      overlap = overlap || (i > 0 && span.first <= named[i - 1].second.last);
    }
    if (texts.size() > kMostNamed + 1) {
      texts[kMostNamed] = std::to_string(texts.size() - kMostNamed) + " more";
      texts.resize(kMostNamed + 1);
    }
    const std::string text = what + boost::algorithm::join(texts, " and ");
    if (overlap) throw std::runtime_error(text + ": " + remedy);
    return named.size() > 1 ? text + ", one after the other: all of them count" : "";
  }

 private:
  static constexpr std::size_t kMostNamed = 2;
  struct Span {
    ros::Time first, last;
    std::size_t number;
  };
  std::map<std::string, Span> spans_;
};

/// "12 messages of /driver"
std::string countsOf(const std::map<std::string, std::size_t>& messages) {
  std::vector<std::string> texts;
  for (const auto& entry : messages) {
    texts.push_back(std::to_string(entry.second) + " messages of " +
                    (entry.first.empty() ? "an unnamed node" : entry.first));
  }
  return boost::algorithm::join(texts, " and ");
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
  const auto requireOther = [&data_set](const std::string& key, const std::string& topic,
                                        const std::string& other_key, const std::string& other) {
    data_set.require(absolute(topic) != absolute(other), key,
                     "be another topic than data_set/" + other_key, "'" + topic + "' for both");
  };
  requireOther("goal_topic", goal_topic, "image_topic", image_topic);
  requireOther("torque_topic", torque_topic, "image_topic", image_topic);
  requireOther("torque_topic", torque_topic, "goal_topic", goal_topic);
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
  if (goal.name == images.name) {
    throw std::runtime_error(
        "topic " + goal.name +
        " is meant by data_set/image_topic and data_set/goal_topic: set one of "
        "them to another topic");
  }
  TrialMessages messages(image_size, options);
  TorqueReader reader(options.motors);
  Publishers publishers, cameras;
  bag.forEachMessage({images.name, torques.name}, [&](const BagMessage& message) {
    if (message.connection.topic == images.name) {
      cameras.take(message.connection.publisher, message.recorded);
      return takeTimeOf(message, &messages);
    }
    const std::optional<TimedTorque> torque = reader.read(message);
    if (!torque) return;
    messages.takeTorque(*torque);
    publishers.take(message.connection.publisher, torque->recorded);
  });
  const std::string without_effort = countsOf(reader.withoutEffort());
  if (publishers.empty()) {
    throw std::runtime_error(
        "topic " + torques.name + " has no torque" +
        (options.motors.empty() ? "" : " of " + boost::algorithm::join(options.motors, " and ")) +
        (without_effort.empty() ? ""
                                : " (" + without_effort + " have no effort or number of them)") +
        ": leave this bag out, or set data_set/torque_topic and motors");
  }
  if (!without_effort.empty()) {
    messages.note("topic " + torques.name + ": " + without_effort +
                  " have no effort or number of the motors and do not count");
  }
  for (const std::string& note :
       {publishers.requireOneAtATime("topic " + torques.name + " has torques of ",
                                     "record the one that moves the motor"),
        cameras.requireOneAtATime("topic " + images.name + " has images of ",
                                  "record each camera on a topic of its own")}) {
    if (!note.empty()) messages.note(note);
  }
  messages.pair(by_stamp ? 0.0 : options.dt);
  std::size_t number = 0;
  bag.forEachMessage({images.name, goal.name}, [&](const BagMessage& message) {
    if (message.connection.topic == goal.name) return takeGoal(message, &messages);
    if (messages.wants(number)) takeImage(message, number, &messages);
    ++number;
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
  if (std::filesystem::exists(path + "/metadata.yaml")) {
    throw std::runtime_error(
        "bag " + path +
        ": is the folder of a recording of ROS 2; only bags of format 2.0 (ROS "
        "1) are read: convert it with `rosbags-convert --src FOLDER --dst FILE.bag` (pip "
        "install rosbags)");
  }
  if (std::filesystem::is_directory(path)) {
    throw std::runtime_error("bag " + path + ": is a folder: name the bags in it");
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

void requireDifferentBags(const std::vector<std::string>& paths) {
  std::map<std::pair<dev_t, ino_t>, std::string> seen;
  for (const std::string& path : paths) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) continue;  // whoever reads it says so
    const auto added = seen.emplace(std::make_pair(status.st_dev, status.st_ino), path);
    if (added.second) continue;
    const std::string& before = added.first->second;
    throw std::runtime_error("bag " + path + " is given twice" +
                             (before == path ? "" : ", also as " + before) +
                             ": it would count twice, so leave one of them out");
  }
}

void DifferentFrames::require(const std::string& path, const BagContent& content) {
  std::map<std::string, std::size_t> shared;  // by bag
  for (const std::size_t id : content.frame_ids) {
    const auto added = seen_.emplace(id, path);
    if (!added.second && added.first->second != path) ++shared[added.first->second];
  }
  const std::size_t all = content.frame_ids.size();
  for (const auto& entry : shared) {
    if (10 * entry.second <= all) continue;
    throw std::runtime_error("bag " + path + ": " + std::to_string(entry.second) + " of its " +
                             std::to_string(all) + " frames are also in bag " + entry.first +
                             ", with the same times: they would count twice, so leave one of the "
                             "bags out, or split the recording without an overlap");
  }
}

}  // namespace ddm
