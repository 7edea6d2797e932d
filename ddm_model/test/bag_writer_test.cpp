// Tests of the bag writer: what is under the final name is complete.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_writer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "ddm_bag_io/bag_reader.h"
#include "ddm_common/plain_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/file_size_limit.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "toy_bags.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::imageMessage;
using testing::throwsNaming;
using testing::torqueMessage;
using testing::toyImage;

class BagWriterTest : public ::testing::Test {
 protected:
  static void writeFrames(BagWriter* writer, int count) {
    for (int t = 0; t < count; ++t) {
      writer->write(imageMessage(1.0 + 0.2 * t, toyImage(0.1 * t)));
      writer->write(torqueMessage(1.0 + 0.2 * t, {0.5 * t}));
    }
  }

  const testing::TempFolder folder_;
  const std::string path_ = folder_.file("trial.bag");
};

TEST_F(BagWriterTest, WritesUnderTheNamesOfTheConfigurationAndCompressed) {
  BagOptions topics;
  topics.image_topic = "/eye";
  topics.torque_topic = "/arm";
  topics.goal_topic = "/aim";
  BagWriter writer(path_, topics);
  writer.writeGoal(imageMessage(0.0, toyImage(3.0)), ros::Time(1.0));
  writeFrames(&writer, 5);
  writer.close();
  const BagContent content = readBag(path_, testing::kToySize, topics);
  EXPECT_EQ(content.data.numFrames(), 5);
  EXPECT_EQ(content.data.goal(), toyImage(3.0));
  EXPECT_NE(readFile(path_).find("compression=lz4"), std::string::npos);
}

TEST_F(BagWriterTest, TakesAnImageStampedZero) {
  BagWriter writer(path_, BagOptions());
  writer.write(imageMessage(0.0, toyImage(0.0)));
  writer.write(torqueMessage(0.0, {1.0}));
  writer.close();
  EXPECT_EQ(readBag(path_, testing::kToySize, BagOptions()).data.numFrames(), 1);
}

TEST_F(BagWriterTest, NamesABagThatCannotBeWrittenOrRenamed) {
  const std::string nowhere = folder_.file("missing/trial.bag");
  EXPECT_TRUE(
      throwsNaming<std::runtime_error>([&] { BagWriter(nowhere, BagOptions()); }, {nowhere}));
  BagWriter writer(path_, BagOptions());
  writeFrames(&writer, 5);
  fs::create_directories(path_ + "/in_the_way");
  EXPECT_TRUE(
      throwsNaming<std::runtime_error>([&] { writer.close(); }, {path_ + ".active", "directory"}));
  EXPECT_TRUE(fs::exists(path_ + ".active"));  // nothing is lost
}

TEST_F(BagWriterTest, SurvivesADiskThatIsFull) {
  EXPECT_TRUE(throwsNaming<std::runtime_error>(
      [this] {
        const testing::FileSizeLimit limit(20000);
        BagWriter writer(path_, BagOptions());
        writeFrames(&writer, 200);  // more than what is kept in memory
        writer.close();
      },
      {path_}));
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(BagWriterTest, ABagThatCannotEvenBeBegunLeavesNothing) {
  const testing::FileSizeLimit limit(0);
  EXPECT_TRUE(
      throwsNaming<std::runtime_error>([this] { BagWriter(path_, BagOptions()); }, {path_}));
  EXPECT_FALSE(fs::exists(path_ + ".active"));
}

}  // namespace
}  // namespace ddm
