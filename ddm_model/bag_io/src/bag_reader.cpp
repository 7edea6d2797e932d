// Reads bags: images and torques on the wire to a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_msgs/Torque.h>
#include <ddm_msgs/image_codec.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

namespace ddm {
namespace {

constexpr double kGap = 1.5;  // in median intervals

/// Everything of one bag that concerns us, in the order of the stamps.
struct Messages {
  std::map<ros::Time, Grey> images;
  std::map<ros::Time, std::vector<double>> torques;
  Grey goal;
  std::string camera;
};

std::string textOf(const ros::Time& stamp) { return std::to_string(stamp.toSec()) + " s"; }

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string absolute(const std::string& topic) {
  return !topic.empty() && topic.front() == '/' ? topic : "/" + topic;
}

/// The recorded topic that `name` means: the one of this name, else one in some namespace.
/// @return empty if there is none
std::string findTopic(rosbag::View* view, const std::string& name, const std::string& type,
                      const std::string& key) {
  std::set<std::string> found;
  bool exact = false;
  for (const rosbag::ConnectionInfo* connection : view->getConnections()) {
    const bool is_exact = absolute(connection->topic) == absolute(name);
    if (!is_exact && (exact || !endsWith(absolute(connection->topic), absolute(name)))) continue;
    if (is_exact && !exact) found.clear();
    exact = is_exact;
    found.insert(connection->topic);
  }
  if (found.size() > 1) {
    throw std::runtime_error("topics " + *found.begin() + " and " + *found.rbegin() +
                             " both match: set data_set/" + key + " to one of them");
  }
  for (const rosbag::ConnectionInfo* connection : view->getConnections()) {
    if (found.count(connection->topic) > 0 && connection->datatype != type) {
      throw std::runtime_error("topic " + connection->topic + " has type " + connection->datatype +
                               ", it must be " + type + ": set data_set/" + key);
    }
  }
  return found.empty() ? "" : *found.begin();
}

std::string requireTopic(rosbag::View* view, const std::string& name, const std::string& type,
                         const std::string& key) {
  const std::string topic = findTopic(view, name, type, key);
  if (!topic.empty()) return topic;
  std::set<std::string> topics;
  for (const rosbag::ConnectionInfo* connection : view->getConnections()) {
    topics.insert(connection->topic);
  }
  std::string there;
  for (const std::string& other : topics) there += " " + other;
  throw std::runtime_error("no topic " + name +
                           " (it holds:" + (there.empty() ? " nothing" : there) +
                           "): record it, or set data_set/" + key);
}

template <class Message>
boost::shared_ptr<Message> instantiate(const rosbag::MessageInstance& instance) {
  boost::shared_ptr<Message> message = instance.instantiate<Message>();
  if (message == nullptr) {
    throw std::runtime_error("topic " + instance.getTopic() +
                             " was recorded with another definition of " + instance.getDataType());
  }
  return message;
}

void takeImage(const sensor_msgs::Image& image, int image_size, Messages* out) {
  const std::string camera =
      std::to_string(image.width) + "x" + std::to_string(image.height) + " " + image.encoding;
  if (out->camera.empty()) out->camera = camera;
  if (camera != out->camera) {
    throw std::runtime_error("the images change from " + out->camera + " to " + camera + " at " +
                             textOf(image.header.stamp) + ": record one camera setting per bag");
  }
  Grey grey;
  try {
    grey = decodeImage(image, image_size);
  } catch (const std::exception& e) {
    throw std::runtime_error("image at " + textOf(image.header.stamp) + ": " + e.what());
  }
  const auto inserted = out->images.emplace(image.header.stamp, grey);
  if (!inserted.second && inserted.first->second != grey) {
    throw std::runtime_error("two different images have the stamp " + textOf(image.header.stamp));
  }
}

void takeTorque(const ddm_msgs::Torque& torque, Messages* out) {
  for (double value : torque.torque) {
    if (!std::isfinite(value)) {
      throw std::runtime_error("the torque at " + textOf(torque.header.stamp) +
                               " must be finite, got " + std::to_string(value) +
                               ": leave this bag out, or mend what commands the motor");
    }
  }
  const size_t dim =
      out->torques.empty() ? torque.torque.size() : out->torques.begin()->second.size();
  if (torque.torque.empty() || torque.torque.size() != dim) {
    throw std::runtime_error("the torque at " + textOf(torque.header.stamp) + " has " +
                             std::to_string(torque.torque.size()) + " value(s) where " +
                             std::to_string(std::max<size_t>(dim, 1)) + " are due");
  }
  const auto inserted = out->torques.emplace(torque.header.stamp, torque.torque);
  if (!inserted.second && inserted.first->second != torque.torque) {
    throw std::runtime_error("two different torques have the stamp " + textOf(torque.header.stamp));
  }
}

void takeGoal(const sensor_msgs::Image& image, int image_size, Messages* out) {
  try {
    out->goal = decodeImage(image, image_size);
  } catch (const std::exception& e) {
    throw std::runtime_error(std::string("goal image: ") + e.what());
  }
}

Messages readMessages(const std::string& path, int image_size, const BagOptions& options) {
  rosbag::Bag bag;
  bag.open(path, rosbag::bagmode::Read);
  rosbag::View all(bag);
  const std::string image_topic =
      requireTopic(&all, options.image_topic, "sensor_msgs/Image", "image_topic");
  const std::string torque_topic =
      requireTopic(&all, options.torque_topic, "ddm_msgs/Torque", "torque_topic");
  const std::string goal_topic =
      findTopic(&all, options.goal_topic, "sensor_msgs/Image", "goal_topic");
  std::vector<std::string> topics = {image_topic, torque_topic};
  if (!goal_topic.empty()) topics.push_back(goal_topic);

  Messages out;
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& instance : view) {
    if (instance.getTopic() == image_topic) {
      takeImage(*instantiate<sensor_msgs::Image>(instance), image_size, &out);
    } else if (instance.getTopic() == torque_topic) {
      takeTorque(*instantiate<ddm_msgs::Torque>(instance), &out);
    } else {
      takeGoal(*instantiate<sensor_msgs::Image>(instance), image_size, &out);
    }
  }
  return out;
}

/// Median interval between frames [s]; 0 if there are fewer than two.
double medianInterval(const std::vector<ros::Time>& stamps) {
  std::vector<double> intervals;
  for (size_t i = 1; i < stamps.size(); ++i) {
    intervals.push_back((stamps[i] - stamps[i - 1]).toSec());
  }
  if (intervals.empty()) return 0.0;
  // The lower of two middle ones: a gap only ever lengthens an interval.
  const auto middle = intervals.begin() + (intervals.size() - 1) / 2;
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

BagContent pairFrames(const Messages& messages, int image_size) {
  if (messages.torques.empty()) throw std::runtime_error("there is no torque in it");
  const int torque_dim = static_cast<int>(messages.torques.begin()->second.size());
  BagContent content{DataSet(image_size, torque_dim), messages.camera};
  std::vector<ros::Time> stamps;
  for (const auto& image : messages.images) {
    if (messages.torques.count(image.first) > 0) stamps.push_back(image.first);
  }
  for (const ros::Time& stamp : stamps) {
    content.times.push_back((stamp - stamps.front()).toSec());
  }
  content.interval = medianInterval(stamps);
  const double gap = kGap * content.interval;
  bool new_piece = true;
  ros::Time last;
  for (const auto& image : messages.images) {
    const auto torque = messages.torques.find(image.first);
    if (torque == messages.torques.end()) {
      ++content.num_images_without_torque;
      new_piece = true;
      continue;
    }
    if (!new_piece && (image.first - last).toSec() > gap) new_piece = true;
    content.data.append(image.second,
                        Eigen::Map<const Eigen::VectorXd>(torque->second.data(), torque_dim),
                        new_piece);
    last = image.first;
    new_piece = false;
  }
  content.num_torques_without_image =
      static_cast<int>(messages.torques.size() - content.data.numFrames());
  if (content.data.numFrames() == 0) {
    throw std::runtime_error("none of its " + std::to_string(messages.images.size()) +
                             " images has a torque with the same header stamp (" +
                             std::to_string(messages.torques.size()) +
                             " torques): stamp each torque with the image it answers");
  }
  if (!messages.goal.empty()) content.data.setGoal(messages.goal);
  return content;
}

}  // namespace

std::vector<std::string> BagOptions::problems() const {
  std::vector<std::string> out;
  const auto require = [&out](const std::string& topic, const std::string& key) {
    if (topic.empty() || topic.back() == '/') {
      out.push_back("data_set/" + key + " must be the name of a topic, got '" + topic + "'");
    }
  };
  require(image_topic, "image_topic");
  require(torque_topic, "torque_topic");
  require(goal_topic, "goal_topic");
  return out;
}

BagContent readBag(const std::string& path, int image_size, const BagOptions& options) {
  if (endsWith(path, ".active")) {
    throw std::runtime_error(
        "bag " + path +
        ": its recording was not completed; `rosbag reindex` recovers what was "
        "written, then rename it to *.bag");
  }
  try {
    return pairFrames(readMessages(path, image_size, options), image_size);
  } catch (const rosbag::BagUnindexedException&) {
    throw std::runtime_error("bag " + path + ": was not closed; run `rosbag reindex` on it");
  } catch (const rosbag::BagException& e) {
    throw std::runtime_error("bag " + path + ": " + e.what() +
                             ": it is cut short, damaged or no bag; copy it again or leave it out");
  } catch (const std::exception& e) {  // ros::serialization has exceptions of its own
    throw std::runtime_error("bag " + path + ": " + e.what());
  }
}

}  // namespace ddm
