// Reads a ROS message from untrusted bytes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/serialization.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace ddm {

/// Stream for ros::serialization that checks the length of each array before it allocates memory.
/// ros::serialization's own stream allocates first, so four corrupt bytes can request 32 GB.
class MessageBytes {
 public:
  MessageBytes(const char* bytes, std::size_t size) : at_(bytes), left_(size) {}

  std::size_t left() const { return left_; }

  template <class Value>
  void next(Value& value) {
    if constexpr (std::is_arithmetic<Value>::value) {
      std::memcpy(&value, take(sizeof(value)), sizeof(value));
    } else {
      ros::serialization::Serializer<Value>::read(*this, value);
    }
  }
  void next(std::string& text) {
    const std::size_t size = count(1);
    text.assign(take(size), size);
  }
  template <class Value>
  void next(std::vector<Value>& values) {
    if constexpr (std::is_arithmetic<Value>::value) {
      values.resize(count(sizeof(Value)));
      const char* const bytes = take(values.size() * sizeof(Value));
      if (!values.empty()) std::memcpy(values.data(), bytes, values.size() * sizeof(Value));
    } else {  // one element at a time, so that memory grows only with the bytes that exist
      values.clear();
      for (std::size_t left = count(1); left > 0; --left) next(values.emplace_back());
    }
  }

 private:
  /// Reads the number of elements of the array that follows.
  /// @throws std::runtime_error if fewer bytes are left
  std::size_t count(std::size_t bytes_each) {
    std::uint32_t number = 0;
    next(number);
    if (number > left_ / bytes_each) {
      throw std::runtime_error("announces " + std::to_string(number) + " elements of " +
                               std::to_string(bytes_each) + " byte(s), and " +
                               std::to_string(left_) + " byte(s) are there");
    }
    return number;
  }
  const char* take(std::size_t size) {
    if (size > left_) throw std::runtime_error("ends early");
    const char* const taken = at_;
    at_ += size;
    left_ -= size;
    return taken;
  }

  const char* at_;
  std::size_t left_;
};

/// Reads one message that fills all bytes.
/// @throws std::runtime_error if the bytes are not exactly one message of this type
template <class Message>
Message messageFromBytes(const char* bytes, std::size_t size) {
  MessageBytes stream(bytes, size);
  Message message;
  stream.next(message);
  if (stream.left() > 0) {
    throw std::runtime_error("has " + std::to_string(stream.left()) + " byte(s) after its end");
  }
  return message;
}

}  // namespace ddm
