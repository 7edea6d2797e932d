// The ROS interface of a simulated plant: the common part of lock-step and real time.
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

/// Answers `reset`, refuses invalid torques, and passes valid torques to the derived class
/// (lock-step or real time). Made for a single-threaded spinner: no callback runs before the
/// construction is complete.
class SimNode {
 public:
  virtual ~SimNode() = default;
  SimNode(const SimNode&) = delete;
  SimNode& operator=(const SimNode&) = delete;

 protected:
  /// @param nh  node handle whose namespace contains the topics
  SimNode(ros::NodeHandle nh, std::unique_ptr<Environment> environment);

  /// Moves the plant by one time step.
  /// @return false if the plant has no next state; the reason has been logged
  bool advance(const Eigen::VectorXd& torque);

  /// Publishes the image of this time step. publishGroundTruth() publishes the other data of the
  /// step.
  /// @return false if the camera has lost the image; nothing of this time step is then published
  bool publishImage(const ros::Time& stamp);

  /// Publishes the ground truth of all images since the last call; the ground truth is kept in
  /// memory until then.
  void publishGroundTruth();

  /// Publishes the torque that acted after an image, saturated at the limits of the motor. Call
  /// this function once for each published image.
  /// @param answer  torque with the stamp of the image; without values if no torque acted in time
  void publishApplied(ddm_msgs::Torque answer) const;

  /// Publishes the goal image of this episode, unless it equals the goal image that was published
  /// last. The answer to `reset` contains the stamp of the valid goal image.
  void publishGoal(const ros::Time& stamp);

  /// Checks a torque like one that arrives on the topic `torque`, and passes it to the derived
  /// class.
  /// @param topic  topic on which the torque arrived, for messages
  void handleTorque(const ddm_msgs::Torque& message, const std::string& publisher,
                    const std::string& topic);
  bool onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response);

  const Plant& plant() const { return environment_->plant(); }
  const ros::Subscriber& torques() const { return torque_sub_; }

 private:
  std::string brokenRule(const Eigen::VectorXd& torque) const;

  /// Begins an episode after the plant has been set to its initial state: publishes the first
  /// image.
  /// @return stamp of the first image
  virtual ros::Time beginTrial(const ddm_msgs::Reset::Request& request) = 0;

  /// Handles a valid torque.
  virtual void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                          const std::string& publisher) = 0;

  /// Handles a refused torque; `reason` contains its publisher and its value, for the log.
  virtual void torqueRefused(const ros::Time& stamp, const std::string& reason) = 0;

  std::unique_ptr<Environment> environment_;
  std::optional<RenderedImage> seen_;  ///< image of this time step; empty if the camera has lost it
  RenderedImage goal_image_;           ///< goal image that was published last
  ros::Time goal_stamp_;               ///< stamp of goal_image_
  /// Ground truth of the images since the last publishGroundTruth().
  std::vector<sensor_msgs::JointState> untold_;
  std::string optical_frame_;  ///< tf frame of the images
  ros::Publisher goal_pub_;
  ros::Publisher ground_truth_pub_;
  ros::Publisher applied_pub_;
  image_transport::Publisher image_pub_;
  ViewPublisher view_;
  ros::ServiceServer reset_server_;
  ros::Subscriber torque_sub_;
};

/// Makes a simulator in lock-step: simulated time stops until the torque for the image arrives, see
/// lockstep_sim.cpp.
std::unique_ptr<SimNode> makeLockstepSim(const ros::NodeHandle& nh,
                                         std::unique_ptr<Environment> environment,
                                         const SimOptions& options, const ShowOptions& show);

/// Makes a simulator in real time: the plant moves without waiting for torques, like a robot, see
/// realtime_sim.cpp.
std::unique_ptr<SimNode> makeRealtimeSim(const ros::NodeHandle& nh,
                                         std::unique_ptr<Environment> environment);

}  // namespace ddm
