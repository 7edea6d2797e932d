// Fuzz target: messages as they lie in a bag, to frames.
// SPDX-License-Identifier: BSD-3-Clause
//
// Input: for each message its kind (1 byte), its size (2 bytes) and its bytes.
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/message_bytes.h>

#include <string>
#include <utility>
#include <vector>

#include "../bag_io/src/torque_reader.h"
#include "../bag_io/src/trial_messages.h"
#include "check_content.h"

namespace {

using Message = std::pair<std::uint8_t, std::string>;  // its kind and its bytes

const ddm::BagConnection& torques() {
  static const ddm::BagConnection torque{"torque", "ddm_msgs/Torque",
                                         ros::message_traits::md5sum<ddm_msgs::Torque>(), ""};
  return torque;
}

sensor_msgs::Image imageFrom(const std::string& bytes) {
  return ddm::messageFromBytes<sensor_msgs::Image>(bytes.data(), bytes.size());
}

void takeFirst(const Message& message, ddm::TorqueReader* reader, ddm::TrialMessages* messages) {
  if (message.first == 0) {
    const auto torque = reader->read({torques(), ros::Time(), message.second});
    if (torque) messages->takeTorque(*torque);
  } else if (message.first == 1) {
    const ros::Time stamp = imageFrom(message.second).header.stamp;
    messages->takeImageTime(stamp, stamp, std::hash<std::string>()(message.second));
  }
}

void takeThen(const Message& message, std::size_t* number, ddm::TrialMessages* messages) {
  if (message.first == 2) {
    messages->takeGoal(imageFrom(message.second));
  } else if (message.first == 1) {
    const sensor_msgs::Image image = imageFrom(message.second);
    if (messages->wants(*number)) messages->takeImage(*number, image, image.encoding);
    ++*number;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kImageSize = 4;
  ddm::testing::FuzzBytes bytes(data, size);
  ddm::TrialMessages messages(kImageSize, ddm::BagOptions());
  ddm::TorqueReader reader({});
  std::vector<Message> all;
  while (!bytes.empty()) {
    const auto kind = static_cast<std::uint8_t>(bytes.number<std::uint8_t>() % 3);
    all.emplace_back(kind, bytes.text(bytes.number<std::uint16_t>()));
    ddm::testing::accepts<std::runtime_error>([&] { takeFirst(all.back(), &reader, &messages); });
  }
  ddm::testing::accepts<std::runtime_error>([&] {
    messages.pair(0.0);
    std::size_t number = 0;
    for (const Message& message : all) takeThen(message, &number, &messages);
    ddm::testing::checkContent(messages.frames(), kImageSize);
  });
  return 0;
}
