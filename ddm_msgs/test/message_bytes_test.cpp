// Tests of messages from bytes: a round trip, and refusal of missing bytes.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_msgs/message_bytes.h"

#include <ddm_msgs/Torque.h>
#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <sensor_msgs/Image.h>

#include <cstring>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

ddm_msgs::Torque torque() {
  ddm_msgs::Torque message;
  message.header.seq = 7;
  message.header.stamp = ros::Time(1.5);
  message.header.frame_id = "camera";
  message.torque = {0.5, -1e-300};
  message.exploratory = 1;
  return message;
}

/// The serialised bytes of a message.
template <class Message>
std::string bytesOf(const Message& message) {
  std::string bytes(ros::serialization::serializationLength(message), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

std::string messageOf(const std::string& bytes) {
  try {
    messageFromBytes<ddm_msgs::Torque>(bytes.data(), bytes.size());
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "accepted";
}

TEST(MessageBytes, AMessageComesBack) {
  const std::string bytes = bytesOf(torque());
  const auto back = messageFromBytes<ddm_msgs::Torque>(bytes.data(), bytes.size());
  EXPECT_EQ(back, torque());
  sensor_msgs::Image image;
  image.encoding = "mono8";
  image.data = {1, 2, 3};
  const std::string image_bytes = bytesOf(image);
  EXPECT_EQ(messageFromBytes<sensor_msgs::Image>(image_bytes.data(), image_bytes.size()), image);
}

TEST(MessageBytes, AMessageCutShortAnywhereOrTooLongIsRefused) {
  const std::string bytes = bytesOf(torque());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_NE(messageOf(bytes.substr(0, size)), "accepted") << size;
  }
  EXPECT_EQ(messageOf(bytes), "accepted");
  EXPECT_TRUE(testing::names(messageOf(bytes + "xy"), {"2 byte"}));
}

TEST(MessageBytes, AnArrayThatIsAnnouncedButNotThereIsRefusedWithBothSizes) {
  std::string bytes = bytesOf(torque());
  const std::size_t count_at = bytes.size() - 1 - 2 * sizeof(double) - 4;
  const std::uint32_t huge = 0xffffffffU;
  std::memcpy(&bytes[count_at], &huge, sizeof(huge));
  EXPECT_TRUE(testing::names(messageOf(bytes), {"4294967295", "8 byte", "17 byte"}));
}

}  // namespace
}  // namespace ddm
