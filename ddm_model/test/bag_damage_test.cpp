// Tests of the bag reader's refusals: each names the bag and what is wrong with it.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <std_msgs/String.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "ddm_bag_io/bag_reader.h"
#include "ddm_bag_io/bag_writer.h"
#include "ddm_common/plain_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/run_program.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "toy_bags.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::imageMessage;
using testing::throwsNaming;
using testing::torqueMessage;
using testing::ToyBag;
using testing::toyImage;

class BagDamage : public testing::BagTest {
 protected:
  std::string goodBytes() const {
    testing::writeTrial(path_, testing::toyTrial(30, 1));
    return readFile(path_);
  }
  void writeBytes(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  }
};

TEST_F(BagDamage, ABagCutShortAnywhereIsRefused) {
  const std::string bytes = goodBytes();
  const size_t size = bytes.size();
  for (size_t kept : {size_t{1}, size_t{13}, size_t{4109}, size / 3, size - 1000, size - 1}) {
    writeBytes(bytes.substr(0, kept));
    EXPECT_TRUE(isRefused({"copy"})) << kept << " of " << size << " bytes";
  }
}

TEST_F(BagDamage, DamageAnywhereIsRefusedOrHarmlessWithEachCompression) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::LZ4, rosbag::compression::BZ2}) {
    {
      rosbag::Bag bag(path_, rosbag::bagmode::Write);
      bag.setCompression(compression);
      bag.write("camera/image_raw", ros::Time(1.0), imageMessage(1.0, toyImage(0.5)));
      bag.write("torque", ros::Time(1.0), torqueMessage(1.0, {2.0}));
    }
    const BagContent content = read();
    EXPECT_EQ(content.data.image(0), toyImage(0.5));
    EXPECT_EQ(content.data.torques()(0, 0), 2.0);
    const std::string bytes = readFile(path_);
    int refused = 0;
    for (size_t at = 4117; at < bytes.size(); ++at) {  // behind the header and its blanks
      std::string damaged = bytes;
      damaged[at] ^= static_cast<char>(1 << at % 8);
      writeBytes(damaged);
      try {
        read();
      } catch (const std::runtime_error&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 100);
  }
}

TEST_F(BagDamage, SizesAreComparedWithWhatIsThereBeforeMemoryIsTaken) {
  const std::string bytes = goodBytes();
  const auto with = [&bytes](const std::string& field, std::uint32_t value) {
    std::string damaged = bytes;
    std::memcpy(&damaged[damaged.find(field) + field.size()], &value, sizeof(value));
    return damaged;
  };
  const std::string chunk_size("\x09\0\0\0size=", 9);
  for (const std::string& field : {chunk_size, std::string("#ROSBAG V2.0\n"),
                                   std::string("index_pos="), std::string("chunk_count=")}) {
    writeBytes(with(field, 0xffffffffU));
    EXPECT_TRUE(isRefused({"copy"})) << field;
  }
  writeBytes(with("index_pos=", 0));
  EXPECT_TRUE(isRefused({"not closed", "rosbag reindex"}));
}

TEST_F(BagDamage, WhatIsInNoIndexDoesNotCountAsInRosbag) {
  const std::string bytes = goodBytes();
  const size_t at = bytes.find("index_pos=") + 10;
  std::uint64_t index = 0;
  std::memcpy(&index, &bytes[at], sizeof(index));
  const std::string junk(77, '\x5a');
  std::string padded = bytes.substr(0, index) + junk + bytes.substr(index) + junk;
  index += junk.size();
  std::memcpy(&padded[at], &index, sizeof(index));
  writeBytes(padded);
  EXPECT_EQ(read().data.numFrames(), 30);
  EXPECT_TRUE(notes({{"77 bytes behind its index are not read", "second bag"}}));
}

TEST_F(BagDamage, WhatPeopleTakeForABagIsToldWithTheCommandThatHelps) {
  const auto text = [](const char* bytes, size_t size) { return std::string(bytes, size); };
  const std::vector<std::pair<std::string, std::string>> formats = {
      {text("\x89MCAP0\r\n\0\0", 10), "rosbags-convert"},
      {text("SQLite format 3\0\x10", 17), "rosbags-convert"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"},
      {"#ROSBAG V1.2\n", "rosbag filter"},
      {text("\x1f\x8b\x08\0", 4), "gunzip"},
      {"PK\x03\x04", "unzip"},
      {"folder/" + std::string(250, '\0') + "ustar", "tar xf"},
      {"\n <?xml version='1.0'?>", "web page"},
      {"<!doctype html>", "web page"}};
  for (const auto& format : formats) {
    writeBytes(format.first);
    EXPECT_TRUE(isRefused({format.second}));
  }
  fs::remove(path_);
  fs::create_directory(path_);
  std::ofstream(path_ + "/metadata.yaml") << "rosbag2_bagfile_information:\n";
  EXPECT_TRUE(isRefused({"rosbags-convert"}));
}

TEST_F(BagDamage, WhatIsNoBagIsRefused) {
  EXPECT_TRUE(isRefused());  // there is none
  writeBytes("");
  EXPECT_TRUE(isRefused({"copy"}));
  writeBytes("step,torque_nm\n0,1.5\n");
  EXPECT_TRUE(isRefused({"copy"}));
  fs::remove(path_);
  fs::create_directory(path_);
  EXPECT_TRUE(isRefused({"folder", "name the bags in it"}));
}

TEST_F(BagDamage, ARecordingThatWasNotCompletedIsRecoveredByTheCommandThatTheErrorsQuote) {
  const std::string left = folder_.file("killed.bag.active");
  BagWriter writer(path_, BagOptions());
  for (int t = 0; t < 400; ++t) {
    writer.write(imageMessage(1.0 + 0.2 * t, toyImage(0.1 * t)));
    writer.write(torqueMessage(1.0 + 0.2 * t, {1.0}));
  }
  fs::copy_file(path_ + ".active", left);  // what a killed recorder leaves
  EXPECT_TRUE(throwsNaming<std::runtime_error>(
      [&] { BagWriter(folder_.file("killed.bag"), BagOptions()); },
      {left + " exists already", "`rosbag reindex " + left, "remove it"}));
  const testing::Outcome outcome = testing::run("rosbag reindex " + left);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  fs::rename(left, folder_.file("killed.bag"));
  const int num_frames =
      readBag(folder_.file("killed.bag"), testing::kToySize, BagOptions()).data.numFrames();
  EXPECT_GT(num_frames, 200) << "all but the last chunk";
}

TEST_F(BagDamage, TopicsThatAreMissingOrOfAnotherTypeAreRefused) {
  { ToyBag(path_).image(1.0, 0.0); }
  EXPECT_TRUE(isRefused({"no topic torque", "camera/image_raw", "data_set/torque_topic"}));
  { ToyBag(path_).torque(1.0, {1.0}); }
  EXPECT_TRUE(isRefused({"no topic camera/image_raw", "data_set/image_topic"}));
  { ToyBag bag(path_); }
  EXPECT_TRUE(isRefused({"it holds: nothing"}));
  {
    ToyBag bag(path_);
    bag.image(1.0, 0.0);
    bag.write("torque", 1.0, std_msgs::String());
  }
  EXPECT_TRUE(isRefused({"std_msgs/String", "ddm_msgs/Torque or", "data_set/torque_topic"}));
}

TEST_F(BagDamage, TorquesThatAreNotFiniteAreRefusedWithTheirTime) {
  {
    ToyBag bag(path_);
    bag.frame(1.0, 0.0, 1.0);
    bag.frame(1.2, 0.0, std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_TRUE(isRefused({"torque at 1.2", "finite"}));
}

TEST_F(BagDamage, ImagesThatChangeSizeOrEncodingAreRefused) {
  sensor_msgs::Image colour = imageMessage(1.2, toyImage(0.1));
  colour.encoding = "8UC1";
  for (const sensor_msgs::Image& other : {imageMessage(1.2, toyImage(0.1, 16), 16), colour}) {
    {
      ToyBag bag(path_);
      bag.frame(1.0, 0.0, 1.0);
      bag.image(1.2, other);
      bag.torque(1.2, {1.0});
    }
    EXPECT_TRUE(isRefused({"8x8 mono8", other.encoding, "1.2"}));
  }
}

TEST_F(BagDamage, ImagesOfWhichFewCanBeDecodedAreRefusedWithTheirTime) {
  sensor_msgs::Image image = imageMessage(1.0, toyImage(0.0));
  image.data.resize(7);
  {
    ToyBag bag(path_);
    bag.image(1.0, image);
    bag.torque(1.0, {1.0});
  }
  EXPECT_TRUE(isRefused({"image at 1.0"}));
  {
    ToyBag bag(path_);
    bag.frame(1.0, 0.0, 1.0);
    bag.goal(1.0, image);
  }
  EXPECT_TRUE(isRefused({"goal image"}));
}

TEST_F(BagDamage, TwoDifferentMessagesWithOneStampAreRefused) {
  {
    ToyBag bag(path_);
    bag.frame(1.0, 0.0, 1.0);
    bag.image(1.0, 0.5);
  }
  EXPECT_TRUE(isRefused({"different images", "data_set/image_topic", "1.0", "stamp each"}));
  {
    ToyBag bag(path_);
    bag.frame(1.0, 0.0, 1.0);
    bag.torque(1.0, {2.0});
  }
  EXPECT_TRUE(isRefused({"different torques", "data_set/torque_topic", "1.0", "stamp each"}));
}

TEST_F(BagDamage, ABagWithoutASinglePairIsRefusedWithTheRemedy) {
  {
    ToyBag bag(path_);
    for (int t = 0; t < 5; ++t) {
      bag.image(1.0 + 0.2 * t, 0.1 * t);
      bag.torque(1.05 + 0.2 * t, {1.0});  // stamped with a time of its own
    }
  }
  EXPECT_TRUE(isRefused({"5 images", "5 torques"}));
}

}  // namespace
}  // namespace ddm
