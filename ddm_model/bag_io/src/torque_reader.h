// Reads torques from the messages of a bag, which may have several types.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bag_file.h"
#include "pairing.h"

namespace ddm {

/// @return types of messages from which a TorqueReader reads
std::vector<std::string> torqueTypes();

/// Whether messages of this type have the stamp of the image that they answer.
bool answersImages(const std::string& type);

/// Reads the torques of one bag.
class TorqueReader {
 public:
  /// @param motors  see BagOptions
  explicit TorqueReader(std::vector<std::string> motors) : motors_(std::move(motors)) {}

  /// @return the torque; empty for a message about other joints, without efforts, or about a time
  ///         in which no single torque acted
  /// @throws std::runtime_error with the time, the fault and the remedy. Faults: a torque is not
  ///         finite; the number of motors changes; motors are not in the message
  std::optional<BagTorque> read(const BagMessage& message);

  /// @return publishers of messages without efforts, as "12 messages of /driver"; empty: none
  std::string withoutEffort() const;

 private:
  std::vector<std::string> motors_;
  std::vector<std::string> names_;                     // joints of the first message
  std::size_t dim_ = 0;                                // number of motors; 0: no torque yet
  std::map<std::string, std::size_t> without_effort_;  // number of messages, by publisher
};

}  // namespace ddm
