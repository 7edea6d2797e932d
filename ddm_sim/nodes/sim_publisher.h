// What the simulator shows on the wire: camera image, ground truth, goal image and clock.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/publisher.h>
#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>

#include <Eigen/Core>
#include <vector>

#include "ddm_sim/plant.h"

namespace ddm {

/// Turns states of a plant and photographs into messages. Advertises in its constructor.
class SimPublisher {
 public:
  /// @param nh      its namespace holds the topics
  /// @param plant   must outlive this object
  /// @param clock   also publish /clock: true in lock-step only
  SimPublisher(ros::NodeHandle nh, const Plant& plant, bool clock);

  /// The goal image, latched: also whoever comes later sees it.
  void publishGoal(const Picture& photograph, const ros::Time& stamp) const;

  /// Simulated time, latched. Must not run backwards.
  void publishClock(const ros::Time& stamp) const;

  /// The image of the present state of the plant. Its ground truth, of the same stamp, is kept for
  /// publishGroundTruth.
  /// @param applied     torque of the step that led here
  /// @param photograph  what the camera shows of it
  void publishFrame(const Eigen::VectorXd& applied, const Picture& photograph,
                    const ros::Time& stamp);

  /// What was kept, one message a frame. Not much later than the frames: each is kept in memory.
  void publishGroundTruth();

 private:
  const Plant& plant_;
  std::vector<sensor_msgs::JointState> kept_;  ///< of frames since the last publishGroundTruth
  ros::Publisher clock_;
  ros::Publisher goal_image_;
  ros::Publisher ground_truth_;
  image_transport::Publisher image_;
};

}  // namespace ddm
