// Limits of a robot's joints, and whether its reports keep them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_robot/clocks.h"
#include "ddm_robot/robot_options.h"

namespace ddm {

/// Compares what the robot reports of its joints (sensor_msgs/JointState) with
/// `robot/position_limits` and `robot/speed_limit`.
///
/// Joints are found by `robot/joints`; a message without any of them is ignored, since several
/// nodes may report, each some joints. Without names a message must have exactly the joints that
/// have limits, in their order. What is needed and is missing, or is not finite, is a violation.
/// So is a joint that two nodes report: one of them may repeat what the other said before it died.
class JointLimits {
 public:
  explicit JointLimits(const RobotOptions& options);

  /// Whether any joint has a limit.
  bool given() const { return !joints_.empty(); }

  /// The robot reports.
  /// @param reporter    name of the node that sent the report
  /// @param names       of its joints, may be empty
  /// @param positions   [rad or m], as many as joints, or none
  /// @param velocities  [rad/s or m/s], as many as joints, or none
  void take(SteadyTime now, const std::string& reporter, const std::vector<std::string>& names,
            const std::vector<double>& positions, const std::vector<double>& velocities);

  /// What the last reports violate; empty: nothing.
  std::string violation() const;

  /// Which joint has not been heard of for kSilence; empty: none.
  std::string silence(SteadyTime now) const;

  /// Slower than all robots report, and short enough for a motor that nobody watches.
  static constexpr std::chrono::milliseconds kSilence{200};
  /// A new reporter within this time is a second one; later, it has replaced the other.
  static constexpr std::chrono::seconds kTakeover{1};

 private:
  struct Joint {
    std::string name;
    bool has_position_limits = false;
    bool has_speed_limit = false;
    double lower = 0.0;  // [rad or m]
    double upper = 0.0;
    double speed_limit = 0.0;  // [rad/s or m/s]
    SteadyTime heard{};
    std::string reporter;    // of the last report
    std::string rival;       // the one it was contested with
    SteadyTime contested{};  // when two nodes last reported it
    std::string violation;
  };

  static std::string findRival(Joint* joint, SteadyTime now, const std::string& reporter);
  static std::string check(const Joint& joint, std::size_t index,
                           const std::vector<double>& positions,
                           const std::vector<double>& velocities);

  bool named_;
  std::vector<Joint> joints_;
  std::string unfit_;  // why the last report without names cannot be used
};

}  // namespace ddm
