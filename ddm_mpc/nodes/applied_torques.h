// The torques that acted after each image, received on the topic `applied_torque`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <map>

namespace ddm {

/// Receives applied torques in the thread that calls after(), which is the image thread.
class AppliedTorques {
 public:
  explicit AppliedTorques(ros::NodeHandle nh) {
    nh.setCallbackQueue(&queue_);
    subscriber_ = nh.subscribe(topics::kAppliedTorque, kQueue, &AppliedTorques::onApplied, this,
                               ros::TransportHints().tcpNoDelay());
  }

  /// Forgets all torques for a new trial, because a simulator that restarts reuses its stamps. Those
  /// in the queue are received first: if their callbacks were removed instead, each later callback
  /// would receive a torque that is too old.
  void forget() {
    queue_.callAvailable();
    torques_.clear();
  }

  /// Finds the torque that acted after an image. It is sent at about the time of the next image and
  /// may arrive after that image, so that this function waits for it up to 20 ms.
  /// @param stamp  stamp of the image
  /// @return       null if none was reported; the decided torque then counts as applied
  ddm_msgs::TorqueConstPtr after(const ros::Time& stamp) {
    const ros::WallDuration limit(0.02);
    if (subscriber_.getNumPublishers() == 0) return nullptr;
    const ros::SteadyTime end = ros::SteadyTime::now() + limit;
    queue_.callAvailable();
    while (torques_.lower_bound(stamp) == torques_.end() && ros::SteadyTime::now() < end) {
      queue_.callAvailable(end - ros::SteadyTime::now());
    }
    const auto found = torques_.find(stamp);
    return found == torques_.end() ? nullptr : found->second;
  }

 private:
  static constexpr int kQueue = 100;

  void onApplied(const ddm_msgs::TorqueConstPtr& applied) {
    torques_[applied->header.stamp] = applied;
    if (torques_.size() > kQueue) torques_.erase(torques_.begin());
  }

  std::map<ros::Time, ddm_msgs::TorqueConstPtr> torques_;  // by stamp; the newest ones
  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
};

}  // namespace ddm
