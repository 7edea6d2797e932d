// The plant behind topics: what lock-step and real time have in common.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Reset.h>
#include <ddm_msgs/Torque.h>
#include <image_transport/publisher.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ddm_sim/environment.h"
#include "view_publisher.h"

namespace ddm {

/// Answers `reset`, refuses torques that no motor could follow, and hands the others to the mode.
/// Made for a single-threaded spinner: no callback runs before the object is complete.
class SimNode {
 public:
  virtual ~SimNode() = default;
  SimNode(const SimNode&) = delete;
  SimNode& operator=(const SimNode&) = delete;

 protected:
  /// @param nh     its namespace holds the topics
  /// @param clock  also publish /clock: true in lock-step only
  SimNode(ros::NodeHandle nh, std::unique_ptr<Environment> environment, bool clock);

  /// One time step.
  /// @return false if the plant has no next state; the reason has been logged
  bool advance(const Eigen::VectorXd& torque);

  /// The image of this time step. publishGroundTruth() publishes the rest.
  /// @return false if the camera has lost the frame: there will be nothing of it
  bool publishFrame(const ros::Time& stamp);

  /// Ground truth of the frames since the last call. Not much later than the frames: that of each
  /// is kept in memory.
  void publishGroundTruth();

  /// What acted as the answer to an image: this torque, as far as the motor can do it. To be called
  /// once for each image that was shown.
  /// @param answer  without a torque: none acted in time
  void publishApplied(ddm_msgs::Torque answer) const;

  /// The goal of this run, unless it looks like the last one: who waits for it knows its stamp from
  /// the answer to `reset`.
  void publishGoal(const ros::Time& stamp);

  /// Simulated time. Must not run backwards.
  void publishClock(const ros::Time& stamp) const;

  const Plant& plant() const { return environment_->plant(); }
  std::string torqueTopic() const { return torque_sub_.getTopic(); }

 private:
  bool onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response);
  void onTorque(const ros::MessageEvent<ddm_msgs::Torque const>& event);
  std::string brokenRule(const Eigen::VectorXd& torque) const;

  /// The plant has been set to its start: show the first image.
  /// @return stamp of that image
  virtual ros::Time beginTrial(const ddm_msgs::Reset::Request& request) = 0;

  /// A torque that the plant can take.
  virtual void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                          const std::string& publisher) = 0;

  /// A torque that was refused; `reason` names its publisher and value, for the log.
  virtual void torqueRefused(const ros::Time& stamp, const std::string& reason) = 0;

  std::unique_ptr<Environment> environment_;
  std::optional<Picture> seen_;                  ///< the frame of this time step; empty: lost
  Picture goal_image_;                           ///< as published last
  ros::Time goal_stamp_;                         ///< of goal_image_
  std::vector<sensor_msgs::JointState> untold_;  ///< of frames since the last publishGroundTruth()
  std::string frame_;                            ///< of the images, in tf
  ros::Publisher clock_pub_;
  ros::Publisher goal_pub_;
  ros::Publisher ground_truth_pub_;
  ros::Publisher applied_pub_;
  image_transport::Publisher image_pub_;
  ViewPublisher view_;
  ros::ServiceServer reset_server_;
  ros::Subscriber torque_sub_;
};

}  // namespace ddm
