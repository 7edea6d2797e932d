// Reads the images and torques of a bag as a data set.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/plain_file.h>
#include <sensor_msgs/CompressedImage.h>
#include <sys/stat.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "bag_file.h"
#include "bag_texts.h"
#include "bag_topics.h"
#include "pairing.h"

namespace ddm {
namespace {

/// @return numbers as text, such as "[1, 2]"
std::string listOf(const std::vector<int>& numbers) {
  std::vector<std::string> texts;
  for (const int number : numbers) texts.push_back(std::to_string(number));
  return "[" + boost::algorithm::join(texts, ", ") + "]";
}

constexpr int kFewGreyValues = 64;  // of 256; a 14 bit image in a 16 bit message has so few

/// Reads the times of an image, and hashes its content without the header.
BagImage bagImageOf(const BagMessage& message, std::size_t number) {
  MessageBytes bytes(message.bytes.data(), message.bytes.size());
  std_msgs::Header header;
  try {
    bytes.next(header);
  } catch (const std::exception& e) {
    refuseMessage(message, e);
  }
  const std::string_view content = message.bytes.substr(message.bytes.size() - bytes.left());
  return {header.stamp, message.recorded, number, std::hash<std::string_view>()(content)};
}

/// Parses a raw or compressed image.
/// @param encoding  out: encoding or format as the camera sent it
/// @throws std::invalid_argument if a compressed image cannot be decoded
sensor_msgs::Image imageOf(const BagMessage& message, std::string* encoding) {
  if (isRaw(message.connection)) {
    auto image = parse<sensor_msgs::Image>(message);
    *encoding = image.encoding;
    return image;
  }
  const auto compressed = parse<sensor_msgs::CompressedImage>(message);
  *encoding = compressed.format;
  return unpacked(compressed);
}

/// Reads the times of all images and torques, and pairs them. Pixels are not decoded, since many
/// images of a fast camera belong to no sample.
Pairs readPairs(BagFile* bag, const BagTopics& topics, const BagOptions& options) {
  TorqueReader reader(options.motors);
  Publishers controllers, cameras;
  std::vector<BagImage> images;
  std::vector<BagTorque> torques;
  bag->forEachMessage({topics.images.name, topics.torques.name}, [&](const BagMessage& message) {
    if (message.connection.topic == topics.images.name) {
      cameras.add(message.connection.publisher, message.recorded);
      images.push_back(bagImageOf(message, images.size()));
    } else if (const std::optional<BagTorque> torque = reader.read(message)) {
      controllers.add(message.connection.publisher, message.recorded);
      torques.push_back(*torque);
    }
  });
  const std::string& topic = topics.torques.name;
  const std::string unknown = reader.withoutEffort();
  if (torques.empty()) {
    const std::string motors = boost::algorithm::join(options.motors, " and ");
    refuseBag("topic ", topic, " has no torque", motors.empty() ? "" : " of " + motors,
              unknown.empty() ? "" : " (" + unknown + " have no effort or number of them)",
              ": leave this bag out, or set data_set/torque_topic and motors");
  }
  std::vector<std::string> notes;
  if (!unknown.empty()) {
    notes.push_back("topic " + topic + ": " + unknown +
                    " have no effort or number of the motors and do not count");
  }
  notes.push_back(controllers.requireOneAtATime("topic " + topic + " has torques of ",
                                                "record the one that moves the motor"));
  notes.push_back(cameras.requireOneAtATime("topic " + topics.images.name + " has images of ",
                                            "record each camera on a topic of its own"));
  notes.erase(std::remove(notes.begin(), notes.end(), ""), notes.end());
  const bool by_stamp = TorqueReader::answersImages(topics.torques.type);
  Pairs pairs = pairUp(std::move(images), std::move(torques), by_stamp ? 0.0 : options.dt);
  pairs.notes.insert(pairs.notes.begin(), notes.begin(), notes.end());
  return pairs;
}

/// Collects the images of the samples of a bag, and its goal image.
class FrameImages {
 public:
  FrameImages(Pairs pairs, int image_size, const BagOptions& options)
      : pairs_(std::move(pairs)),
        image_size_(image_size),
        options_(options),
        greys_(pairs_.frames.size()) {
    for (std::size_t i = 0; i < greys_.size(); ++i) frame_of_[pairs_.frames[i].image] = i;
  }

  /// Adds the next image in the order of the file. An image that cannot be decoded leaves a gap.
  void add(const BagMessage& message) {
    const auto found = frame_of_.find(number_++);
    if (found == frame_of_.end()) return;
    const std::string time = timeText(pairs_.frames[found->second].time);
    try {
      std::string encoding;
      const sensor_msgs::Image image = imageOf(message, &encoding);
      if (image.data.empty()) throw std::invalid_argument("it has no pixels");
      requireSameCamera(image, encoding, time);
      greys_[found->second] = greyOf(image, image_size_, options_);
    } catch (const std::invalid_argument& e) {
      if (num_broken_++ == 0) first_broken_ = "image at " + time + ": " + e.what();
    }
  }

  void setGoal(const BagMessage& message) {
    try {
      std::string encoding;
      goal_ = greyOf(imageOf(message, &encoding), image_size_, options_);
    } catch (const std::exception& e) {
      refuseBag("goal image on ", message.connection.topic, ": ", e.what());
    }
  }

  /// @return all samples, with notes to the user
  /// @throws std::runtime_error if more images are broken than whole
  BagContent content() const {
    if (2 * num_broken_ > greys_.size()) refuseBag(first_broken_);
    const auto torque_dim = static_cast<Eigen::Index>(pairs_.frames.front().torque.size());
    BagContent content{DataSet(image_size_, static_cast<int>(torque_dim)), camera_};
    std::vector<ros::Time> times;
    bool new_segment = false;
    int darkest = 255, brightest = 0;
    for (std::size_t i = 0; i < greys_.size(); ++i) {
      const Pairs::Frame& frame = pairs_.frames[i];
      const Grey& grey = greys_[i];
      new_segment = new_segment || frame.new_segment || grey.empty();
      if (grey.empty()) continue;
      const auto range = std::minmax_element(grey.begin(), grey.end());
      darkest = std::min<int>(darkest, *range.first);
      brightest = std::max<int>(brightest, *range.second);
      times.push_back(frame.time);
      if (pairs_.of_others) content.frame_ids.push_back(idOf(grey, frame));
      content.data.append(grey, Eigen::Map<const Eigen::VectorXd>(frame.torque.data(), torque_dim),
                          new_segment);
      new_segment = false;
    }
    const auto since = [&times](const ros::Time& time) {
      return secondsBetween(times.front(), time);
    };
    for (const ros::Time& time : times) content.times.push_back(since(time));
    content.interval = medianInterval(times);
    for (const ros::Time& time : pairs_.images_without_torque) {
      content.images_without_torque.push_back(since(time));
    }
    for (const ros::Time& time : pairs_.torques_without_image) {
      content.torques_without_image.push_back(since(time) - pairs_.lag);
    }
    if (!goal_.empty()) content.data.setGoal(goal_);
    content.notes = pairs_.notes;
    if (pairs_.of_others && content.data.torques().isZero(0.0)) {
      content.notes.emplace_back("all its torques are 0: record what commands the motors");
    }
    if (num_broken_ > 0) {
      addNote(&content.notes, num_broken_,
              " image(s) cannot be read and leave a gap, the first: ", first_broken_);
    }
    if (brightest - darkest < kFewGreyValues) {
      addNote(&content.notes, "its images (", camera_, ") have grey values from ", darkest, " to ",
              brightest,
              " of 255, so that little can be told apart: scale 10 or 12 "
              "bits, or a depth, to the whole range before they are "
              "recorded");
    }
    return content;
  }

 private:
  void requireSameCamera(const sensor_msgs::Image& image, const std::string& encoding,
                         const std::string& time) {
    const std::string size = textOf(image.width, "x", image.height, " ");
    if (camera_.empty()) camera_ = size + encoding;
    // The format of a compressed image may change without a change of its pixels.
    const bool compressed = encoding != image.encoding;
    if (camera_ == size + encoding) return;
    if (compressed && boost::algorithm::starts_with(camera_, size)) return;
    refuseBag("the images change from ", camera_, " to ", size, encoding, " at ", time,
              ": record one camera setting per bag");
  }

  /// @return hash of time, image and torque of a sample
  static std::size_t idOf(const Grey& grey, const Pairs::Frame& frame) {
    std::string bytes(grey.begin(), grey.end());
    bytes.append(reinterpret_cast<const char*>(frame.torque.data()),
                 frame.torque.size() * sizeof(double));
    return std::hash<std::string>()(bytes + timeText(frame.time));
  }

  Pairs pairs_;
  int image_size_;
  const BagOptions& options_;
  std::map<std::size_t, std::size_t> frame_of_;  // index of the sample, by number of the image
  std::vector<Grey> greys_;                      // of the samples; empty until the image is decoded
  std::size_t number_ = 0;                       // number of the next image
  std::size_t num_broken_ = 0;
  std::string first_broken_;
  Grey goal_;
  std::string camera_;
};

}  // namespace

std::vector<std::string> BagOptions::problems() const {
  OptionChecks data_set("data_set");
  const auto requireTopicName = [&data_set](const std::string& key, const std::string& topic) {
    data_set.require(!topic.empty() && topic.back() != '/', key, "be the name of a topic",
                     "'" + topic + "'");
  };
  requireTopicName("image_topic", image_topic);
  requireTopicName("torque_topic", torque_topic);
  requireTopicName("goal_topic", goal_topic);
  const auto requireOther = [&data_set](const std::string& key, const std::string& topic,
                                        const std::string& other_key, const std::string& other) {
    data_set.require(absolute(topic) != absolute(other), key,
                     "be another topic than data_set/" + other_key, "'" + topic + "' for both");
  };
  requireOther("goal_topic", goal_topic, "image_topic", image_topic);
  requireOther("torque_topic", torque_topic, "image_topic", image_topic);
  requireOther("torque_topic", torque_topic, "goal_topic", goal_topic);
  data_set.requireNotNegative("dt", dt);
  data_set.require(std::none_of(motors.begin(), motors.end(),
                                [](const std::string& motor) { return motor.empty(); }),
                   "motors", "be names", "an empty one");
  data_set.require(crop.size() == 4 && std::all_of(crop.begin(), crop.end(),
                                                   [](int n) { return n >= 0 && n <= 16384; }),
                   "crop", "be [column, row, width, height], each in [0, 16384]", listOf(crop));
  return data_set.problems();
}

Grey greyOf(const sensor_msgs::Image& image, int image_size, const BagOptions& options) {
  const auto size = static_cast<std::uint32_t>(image_size);
  const bool done = image.width == size && image.height == size;  // and needs no crop
  const std::vector<int>& crop = options.crop;
  return decodeImage(image, image_size,
                     done ? ImageCrop() : ImageCrop{crop[0], crop[1], crop[2], crop[3]});
}

BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options) {
  BagFile bag(in);
  const BagTopics topics = findTopics(bag, options);
  FrameImages images(readPairs(&bag, topics, options), image_size, options);
  bag.forEachMessage({topics.images.name, topics.goal.name}, [&](const BagMessage& message) {
    if (message.connection.topic == topics.goal.name) {
      images.setGoal(message);
    } else {
      images.add(message);
    }
  });
  return images.content();
}

BagContent readBag(const std::string& path, int image_size, const BagOptions& options) {
  namespace fs = std::filesystem;
  try {
    if (boost::algorithm::ends_with(path, ".active")) {
      refuseBag(
          "its recording was not completed; `rosbag reindex` recovers what was written, then "
          "rename it to *.bag");
    }
    if (fs::exists(path + "/metadata.yaml")) {
      refuseBag(
          "is the folder of a recording of ROS 2; only bags of format 2.0 (ROS 1) are read: "
          "convert it with `rosbags-convert --src FOLDER --dst FILE.bag` (pip install rosbags)");
    }
    if (fs::is_directory(path)) refuseBag("is a folder: name the bags in it");
    requirePlainFile(path);
    std::ifstream in(path, std::ios::binary);
    if (!in) refuseBag(std::strerror(errno));
    return readBagBytes(&in, image_size, options);
  } catch (const std::exception& e) {
    refuseBag("bag ", path, ": ", e.what());
  }
}

void DifferentBags::require(const std::string& path, const BagContent& content) {
  constexpr char kRemedy[] = ": it would count twice, so leave one of them out";
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    const auto added = files_.emplace(std::make_pair(status.st_dev, status.st_ino), path);
    const std::string& before = added.first->second;
    if (!added.second) {
      refuseBag("bag ", path, " is given twice", before == path ? "" : ", also as " + before,
                kRemedy);
    }
  }
  std::map<std::string, std::size_t> shared;  // number of samples in both, by path of the other bag
  for (const std::size_t id : content.frame_ids) {
    const auto added = frames_.emplace(id, path);
    if (!added.second && added.first->second != path) ++shared[added.first->second];
  }
  const std::size_t all = content.frame_ids.size();
  for (const auto& [other, number] : shared) {
    if (10 * number <= all) continue;
    refuseBag("bag ", path, ": ", number, " of its ", all, " frames are also in bag ", other,
              ", with the same times", kRemedy, ", or split the recording without an overlap");
  }
}

}  // namespace ddm
