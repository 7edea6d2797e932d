// Fuzz target: messages as they lie in a bag, to frames.
// SPDX-License-Identifier: BSD-3-Clause
//
// Input: for each message its kind (1 byte), its size (2 bytes) and its bytes.
#include <ddm_msgs/message_bytes.h>

#include "../bag_io/src/trial_messages.h"
#include "check_content.h"

namespace {

void take(std::uint8_t kind, const std::string& bytes, ddm::TrialMessages* messages) {
  if (kind == 0) {
    messages->takeTorque(ddm::messageFromBytes<ddm_msgs::Torque>(bytes.data(), bytes.size()));
  } else if (kind == 1) {
    messages->takeImage(ddm::messageFromBytes<sensor_msgs::Image>(bytes.data(), bytes.size()));
  } else {
    messages->takeGoal(ddm::messageFromBytes<sensor_msgs::Image>(bytes.data(), bytes.size()));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kImageSize = 4;
  ddm::testing::FuzzBytes bytes(data, size);
  ddm::TrialMessages messages(kImageSize);
  while (!bytes.empty()) {
    const auto kind = static_cast<std::uint8_t>(bytes.number<std::uint8_t>() % 3);
    const std::string message = bytes.text(bytes.number<std::uint16_t>());
    ddm::testing::accepts<std::runtime_error>([&] { take(kind, message, &messages); });
  }
  ddm::testing::accepts<std::runtime_error>(
      [&] { ddm::testing::checkContent(messages.frames(), kImageSize); });
  return 0;
}
