// Torques, whatever the message that carries them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bag_file.h"
#include "pairing.h"

namespace ddm {

/// Reads the torques of one bag.
class TorqueReader {
 public:
  /// The types that are read.
  static const std::vector<std::string>& types();
  /// Whether its messages carry the stamp of the image that they answer.
  static bool answersImages(const std::string& type) { return type == "ddm_msgs/Torque"; }

  /// @param motors  see BagOptions
  explicit TorqueReader(std::vector<std::string> motors) : motors_(std::move(motors)) {}

  /// @return nothing for a message about other joints or without their effort, and where no torque
  ///         acted
  /// @throws std::runtime_error with the time, the fault and the remedy: a torque that is not
  ///         finite, another number of motors than before, motors that are not in the message
  std::optional<TimedTorque> read(const BagMessage& message);

  /// How many messages of each publisher have no effort of the motors.
  const std::map<std::string, std::size_t>& withoutEffort() const { return without_effort_; }

 private:
  using Values = std::vector<double>;

  Values byName(const std::vector<std::string>& names, const Values& values,
                const std::string& topic) const;

  std::vector<std::string> motors_;
  std::vector<std::string> names_;  // of the joints of the first message
  std::size_t dim_ = 0;             // 0: no torque yet
  std::map<std::string, std::size_t> without_effort_;
};

}  // namespace ddm
