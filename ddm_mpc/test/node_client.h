// Test client of mpc_node and view_node: a camera, a source of models, and ears for the answers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/image_codec.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/topics.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <string>
#include <vector>

#include "random_model.h"

namespace ddm {

/// A model as mpc_node and view_node receive it.
inline ddm_msgs::Model modelMessage(const Ddm& model) {
  const std::string bytes = serialiseModel(model);
  ddm_msgs::Model message;
  message.id = modelId(bytes);
  message.data.assign(bytes.begin(), bytes.end());
  return message;
}

/// A bit of it has changed on the way.
inline ddm_msgs::Model damagedModelMessage() {
  ddm_msgs::Model message = modelMessage(randomModel({}));
  message.data.back() ^= 1U;
  return message;
}

/// Collects the messages of one topic.
template <class Message>
class Listener {
 public:
  Listener(ros::NodeHandle nh, const std::string& topic)
      : subscriber_(nh.subscribe<Message>(topic, 1000,
                                          [this](const boost::shared_ptr<Message const>& message) {
                                            messages.push_back(*message);
                                          })) {}
  Listener(const Listener&) = delete;

  bool connected() const { return subscriber_.getNumPublishers() > 0; }

  std::vector<Message> messages;

 private:
  ros::Subscriber subscriber_;
};

/// Handles callbacks until the condition holds.
/// @return false if it does not within the limit [s]
inline bool waitUntil(const std::function<bool()>& condition, double limit = 10.0) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(limit);
  while (!condition()) {
    if (ros::WallTime::now() > end || !ros::ok()) return false;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return true;
}

/// Publishers of what the nodes take in. A stamp is never used twice.
class NodeClient {
 public:
  /// @param ns  of the node's topics
  explicit NodeClient(const std::string& ns = "")
      : nh(ns),
        log(nh, "/rosout"),
        image_(nh.advertise<sensor_msgs::Image>(topics::kImage, 10)),
        model_(nh.advertise<ddm_msgs::Model>(topics::kModel, 1, /*latch=*/true)),
        goal_image_(nh.advertise<sensor_msgs::Image>(topics::kGoalImage, 1)) {}

  bool connect() {
    return waitUntil(
        [this] { return image_.getNumSubscribers() > 0 && model_.getNumSubscribers() > 0; });
  }

  ros::Time nextStamp() {
    stamp_ += ros::Duration(0.2);
    return stamp_;
  }

  /// More than usual, before the next image [s].
  void passTime(double seconds) { stamp_ += ros::Duration(seconds); }

  void publish(const ddm_msgs::Model& model) { model_.publish(model); }

  /// @return its stamp
  ros::Time publishImage(int size, unsigned seed) {
    const ros::Time stamp = nextStamp();
    image_.publish(encodeImage(randomImage(size, seed), size, stamp, "camera"));
    return stamp;
  }

  void publish(const sensor_msgs::Image& image) { image_.publish(image); }

  void publishGoalImage(int size, unsigned seed, const ros::Time& stamp) {
    goal_image_.publish(encodeImage(randomImage(size, seed), size, stamp, "camera"));
  }
  bool goalImageIsHeard() const { return goal_image_.getNumSubscribers() > 0; }

  bool logged(const std::string& part) const {
    for (const rosgraph_msgs::Log& line : log.messages) {
      if (line.msg.find(part) != std::string::npos) return true;
    }
    return false;
  }

  ros::NodeHandle nh;
  Listener<rosgraph_msgs::Log> log;

 private:
  ros::Publisher image_;
  ros::Publisher model_;
  ros::Publisher goal_image_;
  ros::Time stamp_{1000.0};
};

}  // namespace ddm
