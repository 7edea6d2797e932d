// What acted after each image, as the topic `applied_torque` says.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>

namespace ddm {

/// Receives applied torques on a thread of its own, because the thread of the images waits for them.
class AppliedTorques {
 public:
  explicit AppliedTorques(ros::NodeHandle nh) {
    nh.setCallbackQueue(&queue_);
    subscriber_ = nh.subscribe(topics::kAppliedTorque, 10, &AppliedTorques::onApplied, this,
                               ros::TransportHints().tcpNoDelay());
    spinner_.start();
  }
  ~AppliedTorques() { spinner_.stop(); }

  /// For a new trial: a simulator that was started again uses its stamps again.
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    torques_.clear();
  }

  /// What acted after an image. It is sent at about the time of the next image, and may come later.
  /// @param stamp  of the image
  /// @return       null if nobody says so: then the decided torque counts as the applied one
  ddm_msgs::TorqueConstPtr after(const ros::Time& stamp) {
    constexpr std::chrono::milliseconds kLimit(20);
    if (subscriber_.getNumPublishers() == 0) return nullptr;
    std::unique_lock<std::mutex> lock(mutex_);
    came_.wait_for(lock, kLimit, [&] { return torques_.lower_bound(stamp) != torques_.end(); });
    const auto found = torques_.find(stamp);
    return found == torques_.end() ? nullptr : found->second;
  }

 private:
  void onApplied(const ddm_msgs::TorqueConstPtr& applied) {
    constexpr std::size_t kMaxTorques = 100;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      torques_[applied->header.stamp] = applied;
      if (torques_.size() > kMaxTorques) torques_.erase(torques_.begin());
    }
    came_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable came_;
  std::map<ros::Time, ddm_msgs::TorqueConstPtr> torques_;  // by stamp, the newest ones
  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
  ros::AsyncSpinner spinner_{/*thread_count=*/1, &queue_};
};

}  // namespace ddm
