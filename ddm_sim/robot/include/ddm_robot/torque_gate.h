// The gate between a controller and the motors: decides which torque the motors receive.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "ddm_robot/joint_limits.h"
#include "ddm_robot/robot_options.h"

namespace ddm {

/// Passes torques on to the motors if they answer the last images in time, within the limits of
/// each motor.
///
/// Sets the torque of every motor to zero, immediately and without the slew rate limit, in each of
/// these states:
///
///   kStopped        the motors are off: initially, after stop(), and after a latched fault
///   kResetting      the robot moves to its initial state
///   kWaiting        no episode is running
///   kImagesStopped  an episode is running, and no image arrived for two dt
///   kLate           an image had no torque within dt; a later torque does not act
///   kNoController   an episode is running, and no node publishes torques
///   kHeldTooLong    the last torque has acted for robot/max_hold
///   kJointsSilent   the joints have limits, and joint_states does not report them
///
/// The last five states end with the next torque in time. Four faults are latched: a torque that is
/// not one finite number for each motor; a second publisher of torques; no subscriber of the
/// efforts during an episode; and a joint that is beyond its limits, or that two nodes report,
/// while a torque acts or is about to act. A latched fault switches the motors off until arm(),
/// which refuses as long as the fault is present. Between episodes no torque acts, so joints may be
/// moved beyond their limits.
///
/// All deadlines use the monotonic clock, so wrong stamps cannot keep a motor running.
///
/// An episode begins with the first torque in time after arm() and endReset(), and ends with
/// endTrial(). In the state kFollowing, a torque acts until the next torque.
class TorqueGate {
 public:
  enum class State {
    kStopped,
    kResetting,
    kWaiting,
    kFollowing,
    kImagesStopped,
    kLate,
    kNoController,
    kHeldTooLong,
    kJointsSilent
  };

  explicit TorqueGate(const RobotOptions& options);

  /// Switches the motors on.
  /// @return the reason of a refusal; empty if the motors are on
  std::string arm(SteadyTime now);
  /// Describes a present fault that prevents arm(); empty if there is none.
  std::string fault(SteadyTime now) const;
  /// Switches the motors off.
  void stop(const std::string& reason);

  void beginReset();
  void endReset();
  void endTrial();

  /// Records that an image was published to the controller.
  /// @param taken  time at which the camera took the image, not after now; its torque is due within
  ///         dt of this time
  /// @param stamp  stamp of the image, which its torque carries
  void showImage(SteadyTime taken, Stamp stamp);

  /// Handles a torque that has arrived.
  /// @param stamp   stamp of the image that the torque answers
  /// @param torque  [N m]                                                               [numMotors]
  /// @return        whether the torque acts
  bool takeTorque(SteadyTime now, Stamp stamp, const std::vector<double>& torque);

  /// Returns the images since the last call that no torque answered in time. Each published image
  /// has either a torque that acts or an entry here.
  std::vector<Stamp> takeUnanswered();

  /// The torque that the motors follow, within their bounds: the last torque that acts, or zeros if
  /// no torque acts [N m]                                                               [numMotors]
  const std::vector<double>& target() const { return target_; }

  /// Handles a message of joint_states, see JointLimits::take().
  void takeJoints(const JointReport& report);
  /// Describes a joint whose position does not change, see JointLimits::frozen().
  std::string frozenJoint() const { return joints_.frozen(); }

  /// Sets the number of nodes that publish torques. More than one is a fault; zero ends the current
  /// torque.
  void setPublishers(int num_publishers);

  /// Sets the number of nodes that subscribe to the efforts. Zero is a fault, because no torque can
  /// act.
  void setListeners(int num_listeners);

  /// Returns the torque for the motors at this time. Times must not decrease from call to call.
  /// @return torque [N m]                                                               [numMotors]
  const std::vector<double>& effort(SteadyTime now);

  State state() const { return state_; }
  bool armed() const { return state_ != State::kStopped; }
  bool inTrial() const {
    return state_ != State::kStopped && state_ != State::kResetting && state_ != State::kWaiting;
  }
  /// Whether the motors follow the controller or wait for an episode.
  bool isFine() const { return state_ == State::kWaiting || state_ == State::kFollowing; }
  /// Whether the last torque has acted for at least 90 % of a time step and has ended since.
  bool heldForAStep() const { return state_ == State::kHeldTooLong && holds_for_a_step_; }
  /// Describes the state and its cause.
  std::string describe() const;

  /// Number of images in episodes without a torque in time, since construction.
  int numMisses() const { return num_misses_; }
  /// Number of torques in time, since construction.
  int numAnswers() const { return num_answers_; }

 private:
  /// An image whose torque is not due yet.
  struct Pending {
    Stamp stamp;
    SteadyTime taken;
  };

  void expire(SteadyTime now);
  void giveUpFirst();
  void wait();
  void setZero();

  std::vector<double> max_torque_;  // of each motor [N m]
  std::vector<double> slew_rate_;   // of each motor; 0: no bound [N m/s]
  std::chrono::nanoseconds dt_;
  std::chrono::nanoseconds max_hold_;
  bool holds_for_a_step_;
  JointLimits joints_;
  State state_ = State::kStopped;
  bool resetting_ = false;
  std::string stop_reason_ = "service enable arms them";
  int num_publishers_ = 0;
  int num_listeners_ = 1;
  std::deque<Pending> pending_;
  std::vector<Stamp> unanswered_;
  SteadyTime last_image_;
  SteadyTime last_torque_;      // time of the last torque that acted
  std::vector<double> target_;  // [N m]
  std::vector<double> effort_;  // torque that the motors received last [N m]
  SteadyTime last_effort_;
  int num_misses_ = 0;
  int num_answers_ = 0;
};

}  // namespace ddm
