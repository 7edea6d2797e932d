// The gate between a controller and the motors: which torque they get, and when it is zero.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "ddm_robot/joint_limits.h"
#include "ddm_robot/robot_options.h"

namespace ddm {

/// Lets through torques that answer the last images in time, within the limits of each motor.
///
/// Zero torque to every motor, at once and not at the slew rate, in each of these cases:
///
///   kStopped        the motors are off: at the start, after stop(), after a fault that latches
///   kResetting      the robot is on its way to its start
///   kWaiting        no trial is under way
///   kImagesStopped  a trial is under way, and no image came for two dt
///   kLate           an image had no answer within dt. A torque that comes later does not act
///   kNoController   a trial is under way, and no node publishes torques
///   kHeldTooLong    the last torque has acted for robot/max_hold
///   kJointsSilent   the joints have limits, and joint_states does not report them
///
/// The last five end by themselves with the next torque in time. Four faults latch: a torque that
/// is not one finite number for each motor, a second publisher of torques, no subscriber of the
/// efforts in a trial, and a joint beyond its limits, or reported by two nodes, when a torque acts
/// or is about to. They switch the motors off until arm(), which is refused while the fault is
/// there. Between trials, where no torque acts, joints may be moved beyond their limits.
///
/// Time is that of the monotonic clock: whatever stamps say, a motor that hears nothing stops.
///
/// A trial begins with the first torque in time after arm() and endReset(), and ends with
/// endTrial(). In kFollowing a torque acts until the next.
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

  /// Lets torques through from now on.
  /// @return what is in the way; empty: armed
  std::string arm(SteadyTime now);
  /// A fault that is there now: the motors cannot be armed; empty: none.
  std::string fault(SteadyTime now) const;
  /// Switches the motors off.
  void stop(const std::string& reason);

  void beginReset();
  void endReset();
  void endTrial();

  /// An image is shown to the controller.
  /// @param taken  when the camera took it, at the latest now: its torque is due within dt of it
  /// @param stamp  by which its torque will name it
  void showImage(SteadyTime taken, Stamp stamp);

  /// A torque has come.
  /// @param stamp   of the image that it answers
  /// @param torque  [N m]                                                          [numMotors]
  /// @return        whether it acts
  bool takeTorque(SteadyTime now, Stamp stamp, const std::vector<double>& torque);

  /// Images that were shown, and that no torque answered in time, since the last call. Each image
  /// has one of both in the end, a torque that acts or a place here.
  std::vector<Stamp> takeUnanswered();

  /// What the motors follow, within their bounds: the last torque that acts, zeros if none does
  /// [N m]                                                                           [numMotors]
  const std::vector<double>& target() const { return target_; }

  /// What joint_states reports, as in JointLimits::take().
  void takeJoints(const JointReport& report);
  /// A joint whose position does not change, see JointLimits::frozen().
  std::string frozenJoint() const { return joints_.frozen(); }

  /// How many nodes publish torques at present. More than one is a fault; without one, a torque ends.
  void setPublishers(int num_publishers);

  /// How many nodes subscribe to the efforts. Without one, no torque can act: a fault.
  void setListeners(int num_listeners);

  /// What the motors get now. To be called with times that never decrease.
  /// @return torque [N m]                                                            [numMotors]
  const std::vector<double>& effort(SteadyTime now);

  State state() const { return state_; }
  bool armed() const { return state_ != State::kStopped; }
  bool inTrial() const {
    return state_ != State::kStopped && state_ != State::kResetting && state_ != State::kWaiting;
  }
  /// Whether the last torque has acted for (nearly) all of a time step, although it does not act now.
  bool heldForAStep() const { return state_ == State::kHeldTooLong && holds_for_a_step_; }
  /// The state in words, with what brought it about.
  std::string describe() const;

  /// Images of trials that had no torque in time, since the start.
  int numMisses() const { return num_misses_; }
  /// Torques in time, since the start.
  int numAnswers() const { return num_answers_; }

 private:
  /// An image whose torque may still come.
  struct Pending {
    Stamp stamp;
    SteadyTime taken;
  };

  void expire(SteadyTime now);
  void giveUpFirst();
  void wait();
  void setZero();

  std::vector<double> max_torque_;  // of each motor [N m]
  std::vector<double> slew_rate_;   // of each motor; 0: any [N m/s]
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
  SteadyTime last_torque_;      // that acts
  std::vector<double> target_;  // [N m]
  std::vector<double> effort_;  // what the motors got last [N m]
  SteadyTime last_effort_;
  int num_misses_ = 0;
  int num_answers_ = 0;
};

}  // namespace ddm
