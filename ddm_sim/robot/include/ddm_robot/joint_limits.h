// Limits of a robot's joints, and whether its reports keep them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_robot/robot_options.h"
#include "ddm_robot/stamp_check.h"

namespace ddm {

/// What a node reports of some joints (sensor_msgs/JointState), and when the report arrived.
struct JointReport {
  SteadyTime arrival{};
  Stamp clock{0};                  ///< of this machine when the report arrived, since its epoch
  Stamp stamp{0};                  ///< when the joints were measured
  std::string reporter;            ///< name of the node
  std::vector<std::string> names;  ///< of the joints, may be empty
  std::vector<double> positions;   ///< as many as joints, or none [rad or m]
  std::vector<double> velocities;  ///< as many as joints, or none [rad/s or m/s]
};

/// Compares what the robot reports of its joints (sensor_msgs/JointState) with
/// `robot/position_limits` and `robot/speed_limit`.
///
/// Joints are found by `robot/joints`; a message without any of them is ignored, since several
/// nodes may report, each some joints. Only where a single joint has limits may its name be left
/// out; then a message must have exactly one joint. What is needed and is missing, or is not finite,
/// is a violation. So is a joint that two nodes report: one of them may repeat what the other said
/// before it died.
///
/// A report counts from the moment when the joints were measured, not when it arrived: a report
/// whose stamp is missing, is older than kSilence, repeats, or jumps leaves its joints silent.
class JointLimits {
 public:
  explicit JointLimits(const RobotOptions& options);

  /// Whether any joint has a limit.
  bool given() const { return !joints_.empty(); }

  void take(const JointReport& report);

  /// Another torque than before acts from now on.
  void torqueChanges();

  /// What the last reports violate; empty: nothing.
  std::string violation() const;

  /// Which joint has not been measured for kSilence, and why as far as it is known; empty: none.
  std::string silence(SteadyTime now) const;

  /// Which joint has reported exactly the same position while kFrozenTorques torques acted one after
  /// the other, as a driver does that repeats an old value; empty: none. No reason to stop: a robot
  /// may also be held.
  std::string frozen() const;

  /// Slower than all robots report, and short enough for a motor that nobody watches.
  static constexpr std::chrono::milliseconds kSilence{200};
  /// A new reporter within this time is a second one; later, it has replaced the other.
  static constexpr std::chrono::seconds kTakeover{1};
  static constexpr int kFrozenTorques = 10;

 private:
  struct Joint {
    std::string name;
    StampCheck stamps{toSeconds(kSilence), "joint_states driver", "a joint state"};
    std::string refusal;  // of the last report, for its stamp
    bool has_position_limits = false;
    bool has_speed_limit = false;
    double lower = 0.0;  // [rad or m]
    double upper = 0.0;
    double speed_limit = 0.0;  // [rad/s or m/s]
    SteadyTime heard{};        // when it was measured last
    double position = 0.0;     // in the last report [rad or m]
    int torques_since_change = 0;
    std::string reporter;    // of the last report
    std::string rival;       // the one it was contested with
    SteadyTime contested{};  // when two nodes last reported it
    std::string violation;
  };

  static std::string findRival(Joint* joint, SteadyTime now, const std::string& reporter);
  static void take(const JointReport& report, std::size_t index, Joint* joint);
  static std::string check(const Joint& joint, std::size_t index, const JointReport& report);

  bool named_;
  std::vector<Joint> joints_;
  std::string unfit_;  // why the last report without names cannot be used
};

}  // namespace ddm
