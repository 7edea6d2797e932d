// Writes the bag of one trial. A bag under its final name is always complete.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_writer.h"

#include <ddm_common/plain_file.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

namespace ddm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kChunkBytes = 32 * 1024;

/// @return error message of rosbag, with a reason that rosbag omits: a full disk
std::string reason(const std::string& path, const std::exception& e) {
  std::error_code ignored;
  const fs::space_info space = fs::space(fs::absolute(path).parent_path(), ignored);
  return e.what() + std::string(!ignored && space.available < kChunkBytes
                                    ? ". No space left on device: make room, then record again"
                                    : "");
}

/// Creates an empty file. rosbag would overwrite an existing one, perhaps all that is left of a
/// trial.
void claim(const std::string& active) {
  const int file = ::open(active.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file >= 0) {
    ::close(file);
  } else if (errno == EEXIST) {
    throw std::runtime_error(
        "bag " + active +
        " exists already, of a recording that was not completed: `rosbag reindex " + active +
        "` recovers it, then rename it to *.bag; or remove it, or record under another name");
  } else {
    throw std::runtime_error("cannot write bag " + active + ": " + std::strerror(errno));
  }
}

}  // namespace

void CloseBag::operator()(rosbag::Bag* bag) const {
  try {
    bag->close();
    delete bag;
  } catch (const std::exception&) {
    static auto* const leaked = new std::vector<rosbag::Bag*>;
    leaked->push_back(bag);
  }
}

BagWriter::BagWriter(const std::string& path, const BagOptions& options)
    : path_(path), options_(options) {
  claim(path_ + ".active");
  bag_.reset(new rosbag::Bag);
  try {
    bag_->open(path_ + ".active", rosbag::bagmode::Write);
    bag_->setCompression(rosbag::compression::LZ4);
    bag_->setChunkThreshold(kChunkBytes);
  } catch (const std::exception& e) {
    ::unlink((path_ + ".active").c_str());  // it is still empty
    throw std::runtime_error("cannot write bag " + path_ + ".active: " + reason(path_, e));
  }
}

template <class Message>
void BagWriter::writeAt(const std::string& topic, const ros::Time& stamp, const Message& message) {
  try {
    bag_->write(topic, std::max(stamp, ros::TIME_MIN), message);
  } catch (const std::exception& e) {
    throw std::runtime_error("cannot write bag " + path_ + ".active: " + reason(path_, e));
  }
}

void BagWriter::write(const sensor_msgs::Image& image) {
  writeAt(options_.image_topic, image.header.stamp, image);
  images_.insert(image.header.stamp);
}

void BagWriter::write(const ddm_msgs::Torque& torque) {
  writeAt(options_.torque_topic, torque.header.stamp, torque);
  torques_.insert(torque.header.stamp);
}

void BagWriter::writeGoal(const sensor_msgs::Image& goal, const ros::Time& stamp) {
  writeAt(options_.goal_topic, stamp, goal);
}

int BagWriter::numFrames() const {
  return static_cast<int>(
      std::count_if(images_.begin(), images_.end(),
                    [this](const ros::Time& stamp) { return torques_.count(stamp) > 0; }));
}

void BagWriter::close() {
  try {
    bag_->close();
  } catch (const std::exception& e) {
    throw std::runtime_error("cannot complete bag " + path_ + ".active: " + reason(path_, e));
  }
  // Renamed durably before trials.csv lists the trial: a listed trial without its bag is refused.
  renameDurably(path_ + ".active", path_);
}

}  // namespace ddm
