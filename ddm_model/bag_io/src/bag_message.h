// A message of a bag as what it says it is.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/message_bytes.h>
#include <ros/message_traits.h>

#include <stdexcept>

#include "bag_file.h"

namespace ddm {

/// @throws std::runtime_error with the topic, the time and the fault
template <class Message>
Message parse(const BagMessage& message) {
  const BagConnection& connection = message.connection;
  if (connection.md5sum != ros::message_traits::md5sum<Message>()) {
    throw std::runtime_error("topic " + connection.topic +
                             " was recorded with another definition of " + connection.type +
                             ": convert the bag with `rosbag fix`, or record it again");
  }
  try {
    return messageFromBytes<Message>(message.bytes.data(), message.bytes.size());
  } catch (const std::exception& e) {
    throw std::runtime_error("the message of topic " + connection.topic + " recorded at " +
                             std::to_string(message.recorded.toSec()) + " s " + e.what() +
                             ": leave this bag out");
  }
}

}  // namespace ddm
