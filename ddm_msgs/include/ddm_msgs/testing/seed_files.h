// Writes the files that fuzzing begins with.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/serialization.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace ddm {
namespace testing {

/// A message as it is on the wire.
template <class Message>
std::string bytesOf(const Message& message) {
  std::string bytes(ros::serialization::serializationLength(message), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

/// A folder, which is made.
class SeedFolder {
 public:
  explicit SeedFolder(std::string path) : path_(std::move(path)) {
    std::filesystem::create_directories(path_);
  }

  std::string file(const std::string& name) const { return path_ + "/" + name; }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream out(file(name), std::ios::binary | std::ios::trunc);
    if (!(out << bytes).flush()) throw std::runtime_error("cannot write " + file(name));
  }

 private:
  std::string path_;
};

}  // namespace testing
}  // namespace ddm
