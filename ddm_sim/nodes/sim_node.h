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
#include "ddm_sim/sim_options.h"
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
  /// @param nh  its namespace holds the topics
  SimNode(ros::NodeHandle nh, std::unique_ptr<Environment> environment);

  /// One time step.
  /// @return false if the plant has no next state; the reason has been logged
  bool advance(const Eigen::VectorXd& torque);

  /// The image of this time step. publishGroundTruth() publishes the rest.
  /// @return false if the camera has lost the image: nothing of this time step is published
  bool publishImage(const ros::Time& stamp);

  /// Ground truth of the images since the last call, which it keeps in memory until then.
  void publishGroundTruth();

  /// What acted as the answer to an image: this torque, as far as the motor can do it. To be called
  /// once for each image that was shown.
  /// @param answer  without a torque if none acted in time
  void publishApplied(ddm_msgs::Torque answer) const;

  /// The goal of this run, unless it looks like the last one: the answer to `reset` has the stamp of
  /// the goal that counts.
  void publishGoal(const ros::Time& stamp);

  /// Checks a torque as if it had come on the topic `torque`, and hands it to the mode.
  /// @param topic  that the torque came on, for messages
  void handleTorque(const ddm_msgs::Torque& message, const std::string& publisher,
                    const std::string& topic);
  bool onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response);

  const Plant& plant() const { return environment_->plant(); }
  const ros::Subscriber& torques() const { return torque_sub_; }

 private:
  std::string brokenRule(const Eigen::VectorXd& torque) const;

  /// The plant has been set to its initial state: show the first image.
  /// @return stamp of that image
  virtual ros::Time beginTrial(const ddm_msgs::Reset::Request& request) = 0;

  /// A torque that the plant can take.
  virtual void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                          const std::string& publisher) = 0;

  /// A torque that was refused; `reason` names its publisher and value, for the log.
  virtual void torqueRefused(const ros::Time& stamp, const std::string& reason) = 0;

  std::unique_ptr<Environment> environment_;
  std::optional<Picture> seen_;  ///< the image of this time step; empty if the camera has lost it
  Picture goal_image_;           ///< as published last
  ros::Time goal_stamp_;         ///< of goal_image_
  std::vector<sensor_msgs::JointState> untold_;  ///< of images since the last publishGroundTruth()
  std::string optical_frame_;                    ///< of the images, in tf
  ros::Publisher goal_pub_;
  ros::Publisher ground_truth_pub_;
  ros::Publisher applied_pub_;
  image_transport::Publisher image_pub_;
  ViewPublisher view_;
  ros::ServiceServer reset_server_;
  ros::Subscriber torque_sub_;
};

/// Simulated time stands still until each image has its torque, see lockstep_sim.cpp.
std::unique_ptr<SimNode> makeLockstepSim(const ros::NodeHandle& nh,
                                         std::unique_ptr<Environment> environment,
                                         const SimOptions& options, const ShowOptions& show);

/// The plant moves by itself, as a robot does, see realtime_sim.cpp.
std::unique_ptr<SimNode> makeRealtimeSim(const ros::NodeHandle& nh,
                                         std::unique_ptr<Environment> environment);

}  // namespace ddm
