// Torques, whatever the message that carries them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <optional>
#include <string>
#include <vector>

#include "bag_file.h"

namespace ddm {

struct TimedTorque {
  ros::Time time;              ///< of the header; of the recording where there is none
  std::vector<double> torque;  ///< one of each motor [N m]
};

/// Reads the torques of one bag.
class TorqueReader {
 public:
  /// The types that are read.
  static const std::vector<std::string>& types();
  /// Whether its messages carry the stamp of the image that they answer.
  static bool answersImages(const std::string& type) { return type == "ddm_msgs/Torque"; }

  /// @param motors  see BagOptions
  explicit TorqueReader(std::vector<std::string> motors) : motors_(std::move(motors)) {}

  /// @return nothing for a message about other joints, and where no torque acted
  /// @throws std::runtime_error with the time, the fault and the remedy: a torque that is not
  ///         finite, another number of motors than before, motors that are not in the message
  std::optional<TimedTorque> read(const BagMessage& message);

 private:
  using Values = std::vector<double>;

  Values byName(const std::vector<std::string>& names, const Values& values,
                const std::string& topic) const;

  std::vector<std::string> motors_;
  std::vector<std::string> names_;  // of the joints of the first message
  std::size_t dim_ = 0;             // 0: no torque yet
};

}  // namespace ddm
