// Checks the joint states of a robot against limits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_robot/robot_options.h"
#include "ddm_robot/stamp_check.h"

namespace ddm {

/// Joint states in one message (sensor_msgs/JointState), with the time of arrival.
struct JointReport {
  SteadyTime arrival{};            ///< arrival of the message
  Stamp clock{0};                  ///< clock of this machine at the arrival, since its epoch
  Stamp stamp{0};                  ///< time of the measurement
  std::string reporter;            ///< node that published the message
  std::vector<std::string> names;  ///< names of the joints; may be empty
  std::vector<double> positions;   ///< one per joint, or empty [rad or m]
  std::vector<double> velocities;  ///< one per joint, or empty [rad/s or m/s]
};

/// Compares the joint states of a robot (sensor_msgs/JointState) with `robot/position_limits` and
/// `robot/speed_limit`.
///
/// `robot/joints` names the joints with limits. A message without any of these joints is ignored,
/// since several nodes may publish the states of different joints. If only one joint has limits,
/// its name may be left out; each message must then contain exactly one joint. A required value
/// that is missing or not finite is a violation. A joint that two nodes report is also a violation,
/// because one of the nodes may repeat a state of the other node after the other node has ended.
///
/// The age of a report counts from the time of measurement and not from its arrival. If the stamp
/// of a report is missing, older than kSilence, repeated, or jumps, the joints of the report count
/// as silent.
class JointLimits {
 public:
  explicit JointLimits(const RobotOptions& options);

  /// Whether any joint has a limit.
  bool given() const { return !joints_.empty(); }

  void take(const JointReport& report);

  /// Call this function when a new torque begins to act. frozen() counts these calls.
  void torqueChanges();

  /// Describes the limits that the last reports violate; empty if there is no violation.
  std::string violation() const;

  /// Describes a joint that has not been measured for kSilence, and the reason if it is known;
  /// empty if there is no such joint.
  std::string silence(SteadyTime now) const;

  /// Describes a joint whose reported position stayed exactly the same during kFrozenTorques
  /// consecutive torques, as if its driver repeated an old value; empty if there is no such joint.
  /// This is a warning and not a fault, because a person may hold the robot.
  std::string frozen() const;

  /// Time without a measurement after which a joint counts as silent. Longer than the period of the
  /// joint states of all robots, and short enough that a motor may run for this time without joint
  /// states.
  static constexpr std::chrono::milliseconds kSilence{200};
  /// If a second node reports a joint within this time after the first node, the joint has two
  /// reporters; after this time, the second node has replaced the first.
  static constexpr std::chrono::seconds kTakeover{1};
  static constexpr int kFrozenTorques = 10;

 private:
  struct Joint {
    std::string name;
    StampCheck stamps{toSeconds(kSilence), "joint_states driver", "a joint state"};
    std::string refusal;    // why the stamp of the last report was refused
    SteadyTime heard{};     // time of the last measurement
    double position = 0.0;  // in the last report [rad or m]
    int torques_since_change = 0;
    std::string reporter;    // node of the last report
    std::string rival;       // the other node that reported the joint
    SteadyTime contested{};  // last time at which two nodes reported the joint
    std::string violation;
  };

  static std::string findRival(Joint* joint, SteadyTime now, const std::string& reporter);
  std::string check(std::size_t joint, std::size_t index, const JointReport& report) const;

  std::vector<std::vector<double>> position_limits_;  // [lower, upper] of each joint, or empty
  std::vector<double> speed_limit_;                   // of each joint, or empty
  bool named_;
  std::vector<Joint> joints_;
  std::string unfit_;  // why the last report without names cannot be used
};

}  // namespace ddm
