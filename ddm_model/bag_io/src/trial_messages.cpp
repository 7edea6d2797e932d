// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_messages.h"

#include <ddm_images/image_codec.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ddm {
namespace {

constexpr double kGap = 1.5;  // in median intervals

std::string textOf(const ros::Time& stamp) { return std::to_string(stamp.toSec()) + " s"; }

/// Stamps are the order of the frames, so they must be times that can be compared.
void requireTime(const ros::Time& stamp, const std::string& what) {
  if (stamp.nsec < 1000000000U) return;
  throw std::runtime_error("the stamp of " + what + " has " + std::to_string(stamp.nsec) +
                           " nanoseconds in its second: it is damaged");
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

}  // namespace

void TrialMessages::takeImage(const sensor_msgs::Image& image) {
  requireTime(image.header.stamp, "an image");
  const std::string camera =
      std::to_string(image.width) + "x" + std::to_string(image.height) + " " + image.encoding;
  if (camera_.empty()) camera_ = camera;
  if (camera != camera_) {
    throw std::runtime_error("the images change from " + camera_ + " to " + camera + " at " +
                             textOf(image.header.stamp) + ": record one camera setting per bag");
  }
  Grey grey;
  try {
    grey = decodeImage(image, image_size_);
  } catch (const std::exception& e) {
    throw std::runtime_error("image at " + textOf(image.header.stamp) + ": " + e.what());
  }
  const auto inserted = images_.emplace(image.header.stamp, grey);
  if (!inserted.second && inserted.first->second != grey) {
    throw std::runtime_error("two different images have the stamp " + textOf(image.header.stamp));
  }
}

void TrialMessages::takeTorque(const ddm_msgs::Torque& torque) {
  requireTime(torque.header.stamp, "a torque");
  if (torque.torque.empty()) return;  // applied_torque says so where none acted in time
  for (double value : torque.torque) {
    if (!std::isfinite(value)) {
      throw std::runtime_error("the torque at " + textOf(torque.header.stamp) +
                               " must be finite, got " + std::to_string(value) +
                               ": leave this bag out, or mend what commands the motor");
    }
  }
  const size_t dim = torques_.empty() ? torque.torque.size() : torques_.begin()->second.size();
  if (torque.torque.size() != dim) {
    throw std::runtime_error("the torque at " + textOf(torque.header.stamp) + " has " +
                             std::to_string(torque.torque.size()) + " value(s) where " +
                             std::to_string(dim) + " are due");
  }
  const auto inserted = torques_.emplace(torque.header.stamp, torque.torque);
  if (!inserted.second && inserted.first->second != torque.torque) {
    throw std::runtime_error("two different torques have the stamp " + textOf(torque.header.stamp));
  }
}

void TrialMessages::takeGoal(const sensor_msgs::Image& image) {
  try {
    goal_ = decodeImage(image, image_size_);
  } catch (const std::exception& e) {
    throw std::runtime_error(std::string("goal image: ") + e.what());
  }
}

BagContent TrialMessages::frames() const {
  if (torques_.empty()) throw std::runtime_error("there is no torque in it");
  const int torque_dim = static_cast<int>(torques_.begin()->second.size());
  BagContent content{DataSet(image_size_, torque_dim), camera_};
  std::vector<ros::Time> stamps;
  for (const auto& image : images_) {
    if (torques_.count(image.first) > 0) stamps.push_back(image.first);
  }
  for (const ros::Time& stamp : stamps) {
    content.times.push_back((stamp - stamps.front()).toSec());
  }
  content.interval = medianInterval(stamps);
  const double gap = kGap * content.interval;
  bool new_piece = true;
  ros::Time last;
  for (const auto& image : images_) {
    const auto torque = torques_.find(image.first);
    if (torque == torques_.end()) {
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
  content.num_torques_without_image = static_cast<int>(torques_.size() - content.data.numFrames());
  if (content.data.numFrames() == 0) {
    throw std::runtime_error("none of its " + std::to_string(images_.size()) +
                             " images has a torque with the same header stamp (" +
                             std::to_string(torques_.size()) +
                             " torques): stamp each torque with the image it answers");
  }
  if (!goal_.empty()) content.data.setGoal(goal_);
  return content;
}

}  // namespace ddm
