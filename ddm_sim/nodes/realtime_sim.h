// Real time: the plant moves by itself every dt, as a robot would.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "sim_node.h"

namespace ddm {

/// Every dt of wall time: step under the newest torque (zero-order hold), show an image, unless the
/// camera loses it.
///
/// A torque that comes before the next step acts in the whole of it. It is the answer to the last
/// image if it carries that stamp: with the step it is published as applied. Any other torque is
/// late: the image has no answer, and the torque acts unless the one on hold answers a newer image.
///
/// Stamps are wall time, all else goes by the monotonic clock, and no clock is published. A torque
/// acts for two periods at most: without a newer one the motor is switched off. A torque that is
/// refused switches it off at once, until the next reset, and cancels the trial: as on a robot,
/// something is wired wrongly. Starts at rest; a reset sets the state at any time, and its
/// num_steps has no effect.
class RealtimeSim : public SimNode {
 public:
  RealtimeSim(ros::NodeHandle nh, std::unique_ptr<Rig> rig);

 private:
  ros::Time beginTrial(const ddm_msgs::Reset::Request& request) override;
  void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                  const std::string& publisher) override;
  void torqueRefused(const ros::Time& stamp, const std::string& reason) override;

  void switchMotorOff();
  void showFrame(const ros::Time& stamp);
  void settleAnswer();
  void onTick(const ros::SteadyTimerEvent& event);

  Eigen::VectorXd held_;     ///< newest torque, zero when the motor is off
  ros::Time held_stamp_;     ///< of the image that held_ answers, zero when the motor is off
  int steps_held_ = 0;       ///< steps taken under held_
  bool shown_ = false;       ///< the camera has not lost the last frame
  ddm_msgs::Torque answer_;  ///< to the last frame, as it stands; without a torque: none
  bool stopped_ = false;     ///< by a torque that was refused
  ros::Publisher cancel_pub_;
  ros::SteadyTimer timer_;
};

}  // namespace ddm
