// Tests of bags that were not recorded by this project: other torques, a faster camera, other clocks.
// SPDX-License-Identifier: BSD-3-Clause
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/String.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "ddm_bag_io/bag_cache.h"
#include "ddm_bag_io/bag_reader.h"
#include "ddm_common/plain_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "toy_bags.h"

namespace ddm {
namespace {

using testing::imageMessage;
using testing::kToySize;
using testing::toyImage;

constexpr double kBegin = 10.0, kDt = 0.1, kLatency = 0.01;
constexpr int kFrames = 20, kImagesPerFrame = 3;

/// The torque that a controller commands on the image of frame k.
double torqueOf(int k) { return std::sin(3.0 * k); }

/// What is commanded `time` after the beginning: a new torque a moment after each image.
double commandedAt(double time) {
  return torqueOf(static_cast<int>(std::floor((time - kLatency) / kDt + 1e-6)));
}

double angleOf(int image) { return 0.05 * image; }

/// Torques whose messages have neither a header nor names.
template <class Message>
Message numberOf(double u) {
  Message message;
  message.data = static_cast<decltype(message.data)>(u);
  return message;
}
template <class Message>
Message arrayOf(double u) {
  Message message;
  message.data = {static_cast<typename decltype(message.data)::value_type>(u)};
  return message;
}

std_msgs::Float64 floatOf(double u) { return numberOf<std_msgs::Float64>(u); }

class OtherBags : public testing::BagTest {
 protected:
  OtherBags() {
    options_.torque_topic = "command";
    options_.dt = kDt;
  }

  void open() { bag_ = std::make_unique<rosbag::Bag>(path_, rosbag::bagmode::Write); }
  void close() { bag_.reset(); }
  template <class Message>
  void write(const std::string& topic, double time, const Message& message,
             const std::string& publisher = "/recorded") {
    namespace traits = ros::message_traits;
    const auto header = boost::make_shared<ros::M_string>(
        ros::M_string{{"topic", topic},
                      {"type", traits::datatype(message)},
                      {"md5sum", traits::md5sum(message)},
                      {"message_definition", traits::definition(message)},
                      {"callerid", publisher}});
    bag_->write(topic, ros::Time(time), message, header);
  }
  /// A controller's torque on each image of frame k, with no torque in between.
  /// @param make  message of frame k with its torque
  template <class Make>
  void writeTorquePerFrame(const Make& make, double lag = 0.0) {
    for (int k = 0; k < kFrames; ++k) {
      write("command", kBegin + kDt * k + kLatency + lag, make(k, torqueOf(k)));
    }
  }
  void writeFloatPerFrame(double lag = 0.0) {
    writeTorquePerFrame([](int, double u) { return floatOf(u); }, lag);
  }
  /// An image for each frame.
  /// @param stampOf  of frame k
  template <class StampOf>
  void writeImagePerFrame(const StampOf& stampOf, double lag = 0.0) {
    for (int k = 0; k < kFrames; ++k) {
      write("camera/image_raw", kBegin + kDt * k + lag,
            imageMessage(stampOf(k), toyImage(angleOf(kImagesPerFrame * k))));
    }
  }
  /// A camera of 30 Hz.
  void writeImages(const std::function<bool(int)>& isThere = [](int) { return true; }) {
    for (int i = 0; i < kFrames * kImagesPerFrame; ++i) {
      if (!isThere(i)) continue;
      const double stamp = kBegin + kDt / kImagesPerFrame * i;
      write("camera/image_raw", stamp + 0.005, imageMessage(stamp, toyImage(angleOf(i))));
    }
  }
  /// 50 messages a second.
  template <class Make>
  void writeTorques(const Make& make) {
    for (double time = kLatency; time < kDt * kFrames + kLatency; time += 0.02) {
      write("command", kBegin + time, make(commandedAt(time)));
    }
  }
  void writeFloats() { writeTorques(floatOf); }
  static sensor_msgs::JointState jointsOf(const std::vector<std::string>& names,
                                          const std::vector<double>& efforts, double stamp = 0.0) {
    sensor_msgs::JointState message;
    message.header.stamp = ros::Time(stamp);
    message.name = names;
    message.effort = efforts;
    return message;
  }

  /// All frames are there, each with the torque that the controller commanded on its image.
  void expectTorques() const {
    const DataSet data = read().data;
    ASSERT_EQ(data.numFrames(), kFrames);
    for (int k = 0; k < kFrames; ++k) EXPECT_FLOAT_EQ(data.torques()(0, k), torqueOf(k)) << k;
  }
  /// Each frame has the third image of all, and the torque commanded on it.
  void expectAllFrames(int motor = 0) const {
    const BagContent content = read();
    ASSERT_EQ(content.data.numFrames(), kFrames);
    EXPECT_EQ(content.data.segments().size(), 1u);
    EXPECT_NEAR(content.interval, kDt, 1e-6);
    EXPECT_TRUE(content.images_without_torque.empty());
    for (int k = 0; k < kFrames; ++k) {
      EXPECT_EQ(content.data.image(k), toyImage(angleOf(kImagesPerFrame * k))) << k;
      EXPECT_DOUBLE_EQ(content.data.torques()(motor, k), torqueOf(k)) << k;
    }
  }

  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>(path_, rosbag::bagmode::Write);
};

TEST_F(OtherBags, NumbersAndArraysWithoutAHeader) {
  const auto expectReadable = [this](auto make) {
    open();
    writeImages();
    writeTorques(make);
    close();
    expectTorques();
    EXPECT_TRUE(notes({}));
  };
  expectReadable(numberOf<std_msgs::Float32>);
  expectReadable(arrayOf<std_msgs::Float32MultiArray>);
  expectReadable(arrayOf<std_msgs::Float64MultiArray>);
  expectReadable(numberOf<std_msgs::Float64>);
  expectAllFrames();
  options_.motors = {"arm"};
  EXPECT_TRUE(isRefused({"command", "std_msgs/Float64", "data_set/motors"}));
}

TEST_F(OtherBags, PartsOfAWrenchByName) {
  writeImages();
  writeTorques([](double u) {
    geometry_msgs::WrenchStamped message;
    message.wrench.force.z = 100.0;
    message.wrench.torque.z = u;
    return message;
  });
  close();
  EXPECT_TRUE(isRefused({"command", "torque.z", "data_set/motors"}));
  options_.motors = {"torque.w"};
  EXPECT_TRUE(isRefused({"command", "torque.z", "data_set/motors"}));
  options_.motors = {"torque.z"};
  expectAllFrames();
}

TEST_F(OtherBags, EffortsOfJointsByName) {
  writeImages();
  writeTorques([](double u) { return jointsOf({"gripper", "arm"}, {5.0, u}); });
  for (int i = 0; i < 10; ++i) {  // others publish theirs on the same topic
    write("command", kBegin + 0.1 * i, jointsOf({"wheel"}, {7.0}));
    write("command", kBegin + 0.1 * i, jointsOf({"caster"}, {}));
  }
  close();
  EXPECT_TRUE(isRefused({"change from", "gripper, arm", "to wheel", "data_set/motors"}));
  options_.motors = {"arm", "elbow"};
  EXPECT_TRUE(isRefused({"no elbow", "data_set/motors"}));
  options_.motors = {"leg"};
  EXPECT_TRUE(isRefused({"no torque of leg"}));
  options_.motors = {"arm"};
  expectAllFrames();
}

TEST_F(OtherBags, PublishersWithoutEffortOfTheJointsDoNotCount) {
  writeImages();
  writeTorques([](double u) { return jointsOf({"gripper", "arm"}, {5.0, u}); });
  const double unknown = std::nan("");
  for (int i = 0; i < 10; ++i) {
    write("command", kBegin + 0.1 * i, jointsOf({"arm", "gripper"}, {}), "/positions");
    write("command", kBegin + 0.1 * i, jointsOf({"gripper", "arm"}, {unknown, unknown}), "/rates");
  }
  close();
  expectAllFrames(/*motor=*/1);
  EXPECT_TRUE(notes({{"10 messages of /positions", "10 messages of /rates", "no effort"}}));
}

TEST_F(OtherBags, ALagOfTheRecorderDoesNotMoveTorquesWithoutStamps) {
  writeImagePerFrame([](int k) { return kBegin + kDt * k; }, /*lag=*/0.5);
  writeFloatPerFrame(/*lag=*/0.5);
  close();
  expectTorques();
  EXPECT_TRUE(notes({{"0.5 s after their stamps", "model/order by 5"}}));
}

TEST_F(OtherBags, WhereAClockCannotBeTrustedRecordingTimesCount) {
  struct Row {
    const char* fault;
    std::function<double(int)> image, torque;  // stamps of frame k
  };
  const auto right = [](int k) { return kBegin + kDt * k; };
  const auto none = [](int) { return 0.0; };
  const auto at = [&](double jump) {
    return [=](int k) { return right(k) + (k < 9 ? 0.0 : jump); };
  };
  const std::vector<Row> rows = {
      {"image stamps stand still at 7.0", [](int) { return 7.0; }, none},
      {"image stamps go back", at(-5.0), none},
      {"image stamps leap", at(37.0), none},
      {"images have no stamp", [&](int k) { return k % 2 == 0 ? 0.0 : right(k); }, right},
      {"two clocks", [](int k) { return 500.0 + kDt * k; }, right},
      {"torque stamps leap", right, at(100.0)},
      {"torque stamps go back from 10.8", right, at(-0.5)},
      {"torque stamps stand still at 10.0", right,
       [&](int k) { return k < 19 ? 10.0 : right(k); }}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.fault);
    open();
    writeImagePerFrame(row.image);
    writeTorquePerFrame([&](int k, double u) { return jointsOf({"arm"}, {u}, row.torque(k)); });
    close();
    const DataSet data = read().data;
    expectTorques();
    EXPECT_EQ(data.segments().size(), 1U);
    for (int k = 0; k < kFrames; ++k) {
      EXPECT_EQ(data.image(k), toyImage(angleOf(kImagesPerFrame * k))) << k;
    }
    EXPECT_TRUE(notes({{row.fault, "recorded count instead"}}));
  }
}

TEST_F(OtherBags, StampsOfTwoClocksThatOverlapAreReported) {
  writeImagePerFrame([](int k) { return kBegin + kDt * k - 0.7; });
  writeTorquePerFrame(
      [](int k, double u) { return jointsOf({"arm"}, {u}, kBegin + kDt * k + kLatency); });
  close();
  EXPECT_EQ(read().data.numFrames(), kFrames - 7);
  EXPECT_TRUE(notes({{"0.7 s after their stamps", "0 s after theirs"},
                     {"7 image(s)", "before the first torque"}}));
}

TEST_F(OtherBags, ADroppedImageIsReplacedByItsNeighbourOrSplitsTheBag) {
  writeImages([](int i) { return i < 20 || i > 26; });  // those due are 21 and 24; 27 is there
  writeFloats();
  close();
  const BagContent content = read();
  ASSERT_EQ(content.data.segments().size(), 2u);
  EXPECT_EQ(content.data.segments()[0].size, 7);
  EXPECT_EQ(content.data.image(7), toyImage(angleOf(27)));
  EXPECT_DOUBLE_EQ(content.data.torques()(0, 7), torqueOf(9));
  EXPECT_EQ(content.data.numFrames(), kFrames - 2);
  EXPECT_TRUE(notes({{"at 1 place(s)", "after 10.6", "2 segments"}}));
}

TEST_F(OtherBags, EachImageOfACameraWithThisRateCountsHoweverItsTimesJitter) {
  for (int k = 0; k < kFrames; ++k) {
    const double recorded = kBegin + kDt * k + 0.02 * std::sin(2.0 * k);
    write("camera/image_raw", recorded, imageMessage(0.0, toyImage(angleOf(kImagesPerFrame * k))));
    write("command", recorded + kLatency, floatOf(torqueOf(k)));
  }
  close();
  expectTorques();
  EXPECT_EQ(read().data.segments().size(), 1U);
  EXPECT_TRUE(notes({}));
}

TEST_F(OtherBags, ImagesWhoseTimesAreTooIrregularAreRefusedWithThem) {
  for (int k = 0; k < kFrames; ++k) {
    for (const double time : {kBegin + 0.22 * k, kBegin + 0.22 * k + 0.05}) {
      write("camera/image_raw", time, imageMessage(time, toyImage(time)));
    }
  }
  writeFloats();
  close();
  EXPECT_TRUE(isRefused({"irregularly, from 0.05 s to 0.17 s", "dt = 0.1 s", "the camera"}));
}

TEST_F(OtherBags, ATorqueHoldsHoweverLongItTakesAndImagesBeforeTheFirstAreDropped) {
  writeImages();
  for (const int k : {3, 4, 5, 13}) write("command", kBegin + kDt * k + kLatency, floatOf(k));
  close();
  const BagContent content = read();
  ASSERT_EQ(content.data.numFrames(), kFrames - 3);
  EXPECT_EQ(content.data.segments().size(), 1U);
  EXPECT_EQ(content.data.image(0), toyImage(angleOf(3 * kImagesPerFrame)));
  for (int k = 3; k < kFrames; ++k) {
    EXPECT_EQ(content.data.torques()(0, k - 3), k < 5 ? k : k < 13 ? 5 : 13) << k;
  }
  EXPECT_TRUE(notes({{"3 image(s)", "before the first torque"},
                     {"13 of 17 frames", "0.79 s", "until the next"}}));
}

TEST_F(OtherBags, ATorqueFromBeforeTheFirstImageHolds) {
  writeImages();
  write("command", kBegin - 3.0, floatOf(2.5));
  close();
  const BagContent content = read();
  ASSERT_EQ(content.data.numFrames(), kFrames);
  EXPECT_EQ(content.data.torques()(0, 0), 2.5);
  EXPECT_TRUE(notes({{"20 of 20 frames", "at most 5 s"}}));
}

TEST_F(OtherBags, AFewImagesThatTheRecorderGotLateMoveNoTorque) {
  for (int k = 0; k < kFrames; ++k) {
    const double time = kBegin + kDt * k;
    write("camera/image_raw", time + (k % 5 == 2 ? 0.09 : 0.0),
          imageMessage(time, toyImage(0.1 * k)));
  }
  writeFloatPerFrame();
  close();
  expectTorques();
  EXPECT_TRUE(notes({}));
}

TEST_F(OtherBags, TorquesThatAreAllZeroAreReported) {
  writeImages();
  writeTorques([](double) { return floatOf(0.0); });
  close();
  EXPECT_TRUE(notes({{"all its torques are 0"}}));
}

TEST_F(OtherBags, MessagesThatWereRecordedAtOneTimeAreRefused) {
  for (int k = 0; k < kFrames; ++k) {
    write("camera/image_raw", kBegin, imageMessage(kBegin + kDt * k, toyImage(angleOf(k))));
    write("command", kBegin, floatOf(torqueOf(k)));
  }
  close();
  EXPECT_TRUE(isRefused({"recorded at 10.0", "written again", "times of the original"}));
}

TEST_F(OtherBags, ARecordingCountsOnce) {
  writeImages();
  writeFloats();
  close();
  const std::string copy = folder_.file("copy.bag");
  std::filesystem::copy_file(path_, copy);
  const auto isRefused = [this](const std::vector<std::string>& bags,
                                const std::vector<std::string>& words) {
    return testing::throwsNaming<std::runtime_error>(
        [&] { BagCache(kToySize, options_).read(bags); }, words);
  };
  EXPECT_TRUE(isRefused({path_, copy}, {copy, "60 of its 60 images", path_, "count twice"}));
  open();
  writeImages([](int i) { return i >= 1 && i < 7; });  // the samples of the copy are 0, 3, 6, ...
  writeFloats();
  close();
  EXPECT_TRUE(isRefused({copy, path_}, {path_, "6 of its 6 images", "the 60 of bag " + copy}));
  EXPECT_TRUE(isRefused({path_, copy}, {copy, "6 of its 60 images", "the 6 of bag " + path_}));
}

TEST_F(OtherBags, TwoControllersAtOnceAreRefused) {
  writeImages();
  for (int i = 0; i < 20; ++i) {
    write("command", kBegin + 0.1 * i, floatOf(1.0), i % 2 == 0 ? "/teleop" : "/controller");
  }
  close();
  EXPECT_TRUE(isRefused({"command", "/teleop (10 from 10.0", "/controller (10 from 10.1"}));
}

TEST_F(OtherBags, ControllersThatActOneAfterTheOtherAndThoseWithoutANameAreNoTwoAtOnce) {
  const auto expectReadable = [this](const std::function<const char*(int)>& publisherOf,
                                     const std::vector<std::string>& words) {
    open();
    writeImages();
    for (int k = 0; k < kFrames; ++k) {
      write("command", kBegin + kDt * k + kLatency, floatOf(torqueOf(k)), publisherOf(k));
    }
    close();
    expectAllFrames();
    EXPECT_TRUE(notes({words}));
  };
  expectReadable([](int k) { return k % 5 == 1 ? ""
                                    : k < 10   ? "/first"
                                               : "/second"; },
                 {"/first (8 from 10.0", "/second (8 from 11.0", "one after the other"});
  expectReadable([](int k) { return k >= 5 && k < 10 ? "/teleop" : "/controller"; },
                 {"/controller (15 from 10.0", "/teleop (5 from 10.5", "after the other"});
}

TEST_F(OtherBags, ARecordingWhoseClockWasSetBackIsRefusedAndMergedBagsAreNot) {
  const auto expectOrRefuse = [this](double begin, bool refused) {
    open();
    for (const double from : {kBegin, begin}) {
      for (int k = 0; k < kFrames; ++k) {
        const double time = from + kDt * k;
        write("camera/image_raw", time, imageMessage(time, toyImage(from + angleOf(k))));
        write("command", time + kLatency, floatOf(torqueOf(k)));
      }
    }
    close();
    if (refused) {
      EXPECT_TRUE(isRefused({"images", "from 10.0", "again from 10.03", "in a bag of its own"}));
    } else {
      EXPECT_EQ(read().data.numFrames(), 2 * kFrames);
    }
  };
  expectOrRefuse(kBegin + 0.03, /*refused=*/true);  // as a simulation that begins anew
  expectOrRefuse(kBegin - 5.0, /*refused=*/false);
}

TEST_F(OtherBags, TheTimeBetweenFramesMustBeGivenAndSuitTheCamera) {
  writeImages();
  writeFloats();
  close();
  options_.dt = 0.0;
  EXPECT_TRUE(isRefused({"command", "std_msgs/Float64", "data_set/dt"}));
  options_.dt = 0.02;
  EXPECT_TRUE(isRefused({"0.0333", "data_set/dt = 0.02"}));
  for (const double dt : {0.04, 0.05}) {  // frames too fast, and each image on its own
    options_.dt = dt;
    EXPECT_TRUE(isRefused({"every 0.0333 s", "data_set/dt = 0.0", "0.0333 s or 0.0667 s"}));
  }
  options_.dt = kDt / kImagesPerFrame;
  EXPECT_EQ(read().data.numFrames(), kFrames * kImagesPerFrame);
  options_.dt = 0.5;
  EXPECT_TRUE(notes({{"images come every 0.0333 s", "data_set/dt = 0.5 s uses 5 of 60"}}));
  options_.dt = 10.0;  // a rate [Hz] instead
  EXPECT_TRUE(isRefused({"every 0.0333 s", "data_set/dt = 10 s uses 1 of 60", "in seconds"}));
}

TEST_F(OtherBags, OtherClocksAreRefusedWithBothSpans) {
  writeImages();
  write("command", 5000.0, floatOf(1.0));
  write("command", 5001.0, floatOf(1.0));
  close();
  EXPECT_TRUE(isRefused({"from 10.0", "to 11.9", "from 5000.0", "to 5001.0", "one clock"}));
}

/// The bytes of an image file, as an image_transport publishes them.
sensor_msgs::CompressedImage compressedImage(double stamp, const std::string& format,
                                             const std::string& bytes) {
  sensor_msgs::CompressedImage message;
  message.header.stamp = ros::Time(stamp);
  message.format = format;
  message.data.assign(bytes.begin(), bytes.end());
  return message;
}

TEST_F(OtherBags, CompressedImagesAreUnpacked) {
  for (const std::string format : {"png", "jpg"}) {
    open();
    for (int k = 0; k < kFrames; ++k) {
      const std::string file = folder_.file("file." + format);
      writeImageFile(file, imageMessage(0.0, toyImage(angleOf(k))));
      const double stamp = kBegin + kDt * k;  // drivers change what they call the format
      write("camera/image_raw", stamp, compressedImage(stamp, k < 5 ? format : "", readFile(file)));
    }
    writeFloats();
    close();
    const BagContent content = read();
    EXPECT_EQ(content.camera, "8x8 " + format);
    ASSERT_EQ(content.data.numFrames(), kFrames);
    const Image truth = toyImage(angleOf(5)), grey = content.data.image(5);
    for (size_t i = 0; i < truth.size(); ++i) {
      EXPECT_NEAR(grey[i], truth[i], format == "png" ? 0 : 25) << format;
    }
  }
}

TEST_F(OtherBags, ABrokenJpegLeavesAGapThatIsTold) {
  const std::string file = folder_.file("file.jpg");
  writeImageFile(file, imageMessage(0.0, toyImage(1.0, 64), 64));
  const std::string bytes = readFile(file);
  for (const size_t part : {bytes.size() / 20, bytes.size() * 7 / 10}) {  // header alone, or pixels
    open();
    for (int k = 0; k < kFrames; ++k) {
      const double stamp = kBegin + kDt * k;
      write("camera/image_raw/compressed", stamp,
            compressedImage(stamp, "jpeg", k == 12 ? bytes.substr(0, part) : bytes));
    }
    writeFloatPerFrame();
    close();
    const BagContent content = read();
    ASSERT_EQ(content.data.segments().size(), 2U);
    EXPECT_EQ(content.data.segments()[0].size, 12);
    EXPECT_EQ(content.data.torques()(0, 12), torqueOf(13));
    EXPECT_TRUE(notes({{"1 image(s)", "at 11.2"}}));
  }
}

TEST_F(OtherBags, TransportsOfAnImageTopicAreFoundByItsNameOrNamed) {
  writeImages();
  sensor_msgs::CompressedImage broken;
  write("camera/image_raw/compressed", kBegin, broken);
  writeFloats();
  close();
  expectAllFrames();  // of the raw ones
  open();
  write("/robot/camera/image_raw/theora", kBegin, std_msgs::String());
  writeFloats();
  close();
  for (const char* topic : {"camera/image_raw", "/robot/camera/image_raw/theora"}) {
    options_.image_topic = topic;
    EXPECT_TRUE(isRefused({"/robot/camera/image_raw/theora", "transport", "republish"}));
  }
  options_.image_topic = BagOptions().image_topic;
  open();
  write("/left/camera/image_raw", kBegin, imageMessage(kBegin, toyImage(0.0)));
  write("/right/camera/image_raw/compressed", kBegin, broken);
  writeFloats();
  close();
  EXPECT_TRUE(isRefused({"/left/camera/image_raw", "/right/camera/image_raw/compressed", "both"}));
}

TEST_F(OtherBags, ThePartOfTheImageIsTakenThatCounts) {
  for (int i = 0; i < 3; ++i) {
    sensor_msgs::Image image = imageMessage(kBegin + kDt * i, Image(40 * 40, 10), 40);
    for (int row = 20; row < 28; ++row) {
      for (int col = 4; col < 12; ++col) image.data[40 * row + col] = 200;
    }
    write("camera/image_raw", kBegin + kDt * i, image);
  }
  writeFloats();
  close();
  EXPECT_NE(read().data.image(0), Image(kToySize * kToySize, 200));
  options_.crop = {4, 20, 8, 8};
  EXPECT_EQ(read().data.image(0), Image(kToySize * kToySize, 200));
  options_.crop = {4, 20, 8, 80};
  EXPECT_TRUE(isRefused({"crop of 8 x 80", "40 x 40"}));
}

TEST_F(OtherBags, ChunksOfOtherTopicsAreNotRead) {
  bag_->setCompression(rosbag::compression::LZ4);
  bag_->setChunkThreshold(1);  // a chunk for each message
  std_msgs::String other;
  other.data = std::string(2000, 'x');
  write("log", kBegin, other);
  writeImages();
  writeFloats();
  close();
  std::string bytes = readFile(path_);
  const size_t chunk = bytes.find("compression=lz4");
  for (int i = 0; i < 8; ++i) bytes[chunk + 60 + i] ^= char(0x55);  // in the first chunk
  std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
  expectAllFrames();
}

}  // namespace
}  // namespace ddm
