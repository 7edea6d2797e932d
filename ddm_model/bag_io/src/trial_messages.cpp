// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_messages.h"

#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

std::string textOf(const ros::Time& time) { return std::to_string(time.toSec()) + " s"; }

/// Times are the order of the frames, so they must be times that can be compared.
void requireTime(const ros::Time& time, const std::string& what) {
  if (time.nsec < 1000000000U) return;
  throw std::runtime_error("the stamp of " + what + " has " + std::to_string(time.nsec) +
                           " nanoseconds in its second: it is damaged");
}

std::string spanOf(const ros::Time& first, const ros::Time& last) {
  return "from " + textOf(first) + " to " + textOf(last);
}

}  // namespace

void TrialMessages::takeImageTime(const ros::Time& time) {
  requireTime(time, "an image");
  times_.insert(time);
}

void TrialMessages::takeTorque(TimedTorque torque) {
  requireTime(torque.time, "a torque");
  torques_.push_back(std::move(torque));
}

void TrialMessages::pair(double dt) {
  pairs_ = dt > 0.0 ? pairInTime(times_, torques_, dt) : pairByStamp(times_, torques_);
  if (pairs_.frames.empty()) {
    const std::string counts = std::to_string(times_.size()) + " images and " +
                               std::to_string(torques_.size()) + " torques";
    if (dt > 0.0 && !times_.empty()) {
      throw std::runtime_error("of its " + counts + ", images come " +
                               spanOf(*times_.begin(), *times_.rbegin()) + " and torques " +
                               spanOf(torques_.front().time, torques_.back().time) +
                               ": record both at once, stamped by one clock");
    }
    throw std::runtime_error("of its " + counts +
                             ", no two have the same header stamp: stamp each torque with the "
                             "image it answers");
  }
  for (const Pairs::Frame& frame : pairs_.frames) images_[frame.image];
}

Grey TrialMessages::decode(const sensor_msgs::Image& image, const std::string& what) const {
  try {
    return greyOf(image, image_size_, options_);
  } catch (const std::exception& e) {
    throw std::runtime_error(what + ": " + e.what());
  }
}

void TrialMessages::takeImage(const ros::Time& time, const sensor_msgs::Image& image,
                              const std::string& encoding) {
  const std::string camera =
      std::to_string(image.width) + "x" + std::to_string(image.height) + " " + encoding;
  if (camera_.empty()) camera_ = camera;
  if (camera != camera_) {
    throw std::runtime_error("the images change from " + camera_ + " to " + camera + " at " +
                             textOf(time) + ": record one camera setting per bag");
  }
  Grey grey = decode(image, "image at " + textOf(time));
  Grey& kept = images_.at(time);
  if (!kept.empty() && kept != grey) {
    throw std::runtime_error("two different images have the stamp " + textOf(time));
  }
  kept = std::move(grey);
}

void TrialMessages::takeGoal(const sensor_msgs::Image& image) {
  goal_ = decode(image, "goal image");
}

BagContent TrialMessages::frames() const {
  const std::vector<Pairs::Frame>& frames = pairs_.frames;
  const auto torque_dim = static_cast<Eigen::Index>(frames.front().torque.size());
  BagContent content{DataSet(image_size_, static_cast<int>(torque_dim)), camera_};
  const ros::Time begin = frames.front().image;
  const auto since = [begin](const ros::Time& time) { return (time - begin).toSec(); };
  for (const Pairs::Frame& frame : frames) {
    content.times.push_back(since(frame.image));
    content.data.append(images_.at(frame.image),
                        Eigen::Map<const Eigen::VectorXd>(frame.torque.data(), torque_dim),
                        frame.new_segment);
  }
  content.interval = pairs_.interval();
  for (const ros::Time& time : pairs_.images_without_torque) {
    content.images_without_torque.push_back(since(time));
  }
  for (const ros::Time& time : pairs_.torques_without_image) {
    content.torques_without_image.push_back(since(time));
  }
  if (!goal_.empty()) content.data.setGoal(goal_);
  return content;
}

}  // namespace ddm
