// Tests of the image codec: all encodings and all refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/image_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Makes a message without padding from pixels of any type.
template <class Value>
sensor_msgs::Image makeImage(const std::string& encoding, int width, int height,
                             const std::vector<Value>& values) {
  sensor_msgs::Image image;
  image.encoding = encoding;
  image.width = width;
  image.height = height;
  image.data.resize(values.size() * sizeof(Value));
  std::memcpy(image.data.data(), values.data(), image.data.size());
  image.step = static_cast<std::uint32_t>(image.data.size()) / image.height;
  return image;
}

/// Makes a message of `width` x `height` pixels that all have the given channels.
template <class Value>
sensor_msgs::Image makeUniform(const std::string& encoding, int width, int height,
                               const std::vector<Value>& pixel) {
  std::vector<Value> values;
  for (int i = 0; i < width * height; ++i) values.insert(values.end(), pixel.begin(), pixel.end());
  return makeImage(encoding, width, height, values);
}

sensor_msgs::Image makeRamp(int width, int height) {
  Bytes values;
  for (int i = 0; i < width * height; ++i) values.push_back(static_cast<std::uint8_t>(i % 251));
  return makeImage("mono8", width, height, values);
}

void expectRefusal(const sensor_msgs::Image& image, const std::vector<std::string>& parts,
                   int size = 2, const ImageCrop& crop = {}) {
  EXPECT_TRUE(
      testing::throwsNaming<std::invalid_argument>([&] { decodeImage(image, size, crop); }, parts));
}

TEST(ImageCodec, DecodesWhatItEncodes) {
  const Bytes grey = makeRamp(51, 51).data;
  EXPECT_EQ(decodeImage(encodeImage(grey, 51, ros::Time(1), "camera"), 51), grey);
}

TEST(ImageCodec, RefusesToEncodeTheWrongNumberOfGreyValues) {
  EXPECT_THROW(encodeImage(Bytes(3), 2, ros::Time(), ""), std::invalid_argument);
  EXPECT_THROW(encodeImage(Bytes(5), 2, ros::Time(), ""), std::invalid_argument);
  EXPECT_THROW(encodeImage(Bytes(), 0, ros::Time(), ""), std::invalid_argument);
  EXPECT_THROW(encodeImage(Bytes(1), -1, ros::Time(), ""), std::invalid_argument);
}

TEST(ImageCodec, AveragesTheAreaWhenItShrinks) {
  const Bytes values = {10, 20, 0,   0,    //
                        30, 40, 0,   0,    //
                        0,  0,  255, 255,  //
                        0,  0,  255, 255};
  EXPECT_EQ(decodeImage(makeImage("mono8", 4, 4, values), 2), Bytes({25, 0, 0, 255}));
}

TEST(ImageCodec, KeepsAUniformGreyAtEverySize) {
  for (const int from : {1, 2, 5, 51, 64}) {
    for (const int to : {1, 2, 3, 51, 100}) {
      const auto image = makeUniform<std::uint8_t>("mono8", from, from, {77});
      EXPECT_EQ(decodeImage(image, to), Bytes(to * to, 77)) << from << " to " << to;
    }
  }
}

TEST(ImageCodec, CutsAnImageToItsCentralSquareAndAnOddRowAtTheBottom) {
  const Bytes wide = {9, 1, 2, 9,  //
                      9, 3, 4, 9};
  EXPECT_EQ(decodeImage(makeImage("mono8", 4, 2, wide), 2), Bytes({1, 2, 3, 4}));
  const Bytes tall = {9, 9, 1, 2, 3, 4, 9, 9, 9, 9};
  EXPECT_EQ(decodeImage(makeImage("mono8", 2, 5, tall), 2), Bytes({1, 2, 3, 4}));
}

TEST(ImageCodec, WeighsTheColoursOfEveryLayout) {
  const auto expectRed = [](const std::string& encoding, const auto& pixel) {
    const Bytes red_is_76(4, 76);  // 0.299 * 255
    EXPECT_EQ(decodeImage(makeUniform(encoding, 2, 2, pixel), 2), red_is_76) << encoding;
  };
  for (const char* encoding : {"rgb8", "RGB8"}) expectRed(encoding, Bytes{255, 0, 0});
  for (const char* encoding : {"bgr8", "BGR8", "8UC3"}) expectRed(encoding, Bytes{0, 0, 255});
  expectRed("rgba8", Bytes{255, 0, 0, 13});
  for (const char* encoding : {"bgra8", "8UC4"}) expectRed(encoding, Bytes{0, 0, 255, 13});
  using Words = std::vector<std::uint16_t>;
  expectRed("rgb16", Words{65535, 0, 0});
  expectRed("16UC3", Words{0, 0, 65535});
  expectRed("bgra16", Words{0, 0, 65535, 1300});
}

TEST(ImageCodec, DividesSixteenBitGreyBy257) {
  const std::vector<std::uint16_t> values = {0, 257 * 100, 257 * 100 + 128, 65535};
  for (const char* encoding : {"mono16", "16UC1", "MONO16"}) {
    EXPECT_EQ(decodeImage(makeImage(encoding, 2, 2, values), 2), Bytes({0, 100, 100, 255}))
        << encoding;
  }
}

TEST(ImageCodec, RoundsFloatGreyToTheNearestOf255) {
  EXPECT_EQ(decodeImage(makeImage<float>("32FC1", 2, 2, {0.0f, 1.0f, 0.5f, 0.1f / 255}), 2),
            Bytes({0, 255, 128, 0}));
  EXPECT_EQ(decodeImage(makeImage<double>("64FC1", 2, 2, {0.0, 1.0, 100.4 / 255, 100.6 / 255}), 2),
            Bytes({0, 255, 100, 101}));
}

TEST(ImageCodec, RefusesFloatsThatAreNoGreyValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, -0.001, 1.001, 255.0}) {
    expectRefusal(makeImage<float>("32FC1", 2, 2, {0, 0, static_cast<float>(bad), 0}),
                  {"row 1, column 0"});
    expectRefusal(makeImage<double>("64FC1", 2, 2, {0, bad, 0, 0}), {"row 0, column 1"});
  }
  // outside the central square
  expectRefusal(makeImage<float>("32FC1", 4, 2, {2, 0, 0, 0, 0, 0, 0, 0}), {"row 0, column 0"});
}

TEST(ImageCodec, DemosaicsEveryBayerPattern) {
  for (const char* pattern : {"bayer_rggb", "bayer_bggr", "bayer_gbrg", "bayer_grbg"}) {
    EXPECT_EQ(decodeImage(makeUniform<std::uint8_t>(pattern + std::string("8"), 6, 6, {90}), 4),
              Bytes(16, 90))
        << pattern;
    EXPECT_EQ(
        decodeImage(makeUniform<std::uint16_t>(pattern + std::string("16"), 6, 6, {257 * 90}), 4),
        Bytes(16, 90))
        << pattern;
  }
}

TEST(ImageCodec, KnowsWhichBayerPixelsAreRed) {
  // Only the top left pixel of each block of 2 x 2 is bright: a red scene for bayer_rggb8, a blue
  // scene for bayer_bggr8.
  Bytes mosaic;
  for (int i = 0; i < 64; ++i) mosaic.push_back((i % 8) % 2 == 0 && (i / 8) % 2 == 0 ? 200 : 0);
  const int red = decodeImage(makeImage("bayer_rggb8", 8, 8, mosaic), 1)[0];
  const int blue = decodeImage(makeImage("bayer_bggr8", 8, 8, mosaic), 1)[0];
  EXPECT_NEAR(red, 0.299 * 200, 12);
  EXPECT_NEAR(blue, 0.114 * 200, 12);
}

TEST(ImageCodec, TakesTheLumaOfYuv422) {
  const Bytes u_y_v_y = {128, 10, 129, 20,  //
                         128, 30, 129, 40};
  for (const char* encoding : {"yuv422", "uyvy", "UYVY", "uyvy422", "yuv422_uyvy"}) {
    EXPECT_EQ(decodeImage(makeImage(encoding, 2, 2, u_y_v_y), 2), Bytes({10, 20, 30, 40}));
  }
  const Bytes y_u_y_v = {10, 128, 20, 129, 99, 99,  // with padding
                         30, 128, 40, 129, 99, 99};
  for (const char* encoding : {"yuyv", "YUYV", "yuy2", "yuyv422", "yuv422_yuy2"}) {
    EXPECT_EQ(decodeImage(makeImage(encoding, 2, 2, y_u_y_v), 2), Bytes({10, 20, 30, 40}));
  }
}

TEST(ImageCodec, ReadsThePaddedRowsOfEveryDepthFromTheTopLeft) {
  const Bytes bytes = {1, 2, 99, 3, 4, 99};
  EXPECT_EQ(decodeImage(makeImage("mono8", 2, 2, bytes), 2), Bytes({1, 2, 3, 4}));
  const std::vector<std::uint16_t> words = {257, 514, 9999, 771, 1028, 9999};
  EXPECT_EQ(decodeImage(makeImage("mono16", 2, 2, words), 2), Bytes({1, 2, 3, 4}));
  const std::vector<float> floats = {0.0f, 1.0f, 9.0f, 1.0f, 0.0f, 9.0f};
  EXPECT_EQ(decodeImage(makeImage("32FC1", 2, 2, floats), 2), Bytes({0, 255, 255, 0}));
}

TEST(ImageCodec, RefusesAnUnknownEncodingAndNamesTheKnownOnes) {
  for (const char* encoding : {"", "mono12", "16SC1", "8UC2", "32FC3", "jpeg"}) {
    sensor_msgs::Image image = makeRamp(2, 2);
    image.encoding = encoding;
    expectRefusal(image, {"encoding", "'" + std::string(encoding) + "'", "bayer_rggb8"});
  }
}

TEST(ImageCodec, RefusesASizeThatNoImageHasBeforeItMultipliesIt) {
  expectRefusal(sensor_msgs::Image(), {"image: "});
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  for (const auto& [width, height] : {std::make_pair(0U, 2U), {2U, 16385U}, {kMost, kMost}}) {
    sensor_msgs::Image image = makeRamp(2, 2);
    image.width = image.step = width;
    image.height = height;
    expectRefusal(image, {"[1, 16384]", std::to_string(width) + " x " + std::to_string(height)});
  }
}

TEST(ImageCodec, RefusesRowsThatDoNotFitTheirPixelsOrTheData) {
  sensor_msgs::Image narrow = makeUniform<std::uint8_t>("rgb8", 2, 2, {1, 2, 3});
  narrow.step = 5;
  narrow.data.resize(10);
  expectRefusal(narrow, {"step", "6 bytes", "got 5"});
  expectRefusal(makeUniform<std::uint8_t>("bayer_rggb8", 2, 4, {1}), {"3 x 3", "got 2 x 4"});
  expectRefusal(makeUniform<std::uint8_t>("yuv422", 3, 2, {128, 1}), {"even width", "got 3 x 2"});
  for (const std::size_t bytes : {0, 3, 5}) {
    sensor_msgs::Image image = makeRamp(2, 2);
    image.data.resize(bytes);
    expectRefusal(image, {"data", " 4 bytes", "got " + std::to_string(bytes)});
  }
}

TEST(ImageCodec, TurnsBigEndianPixelsOfSeveralBytes) {
  const auto isTurned = [](sensor_msgs::Image image, std::ptrdiff_t bytes_each) {
    const Bytes expected = decodeImage(image, 2);
    for (auto at = image.data.begin(); at != image.data.end(); at += bytes_each) {
      std::reverse(at, at + bytes_each);
    }
    image.is_bigendian = 1;
    EXPECT_EQ(decodeImage(image, 2), expected) << image.encoding;
  };
  isTurned(makeImage<std::uint16_t>("mono16", 2, 2, {257, 2570, 25700, 65535}), 2);
  isTurned(makeUniform<std::uint16_t>("rgb16", 2, 2, {257, 2570, 25700}), 2);
  isTurned(makeImage<float>("32FC1", 2, 2, {0.1f, 0.2f, 0.3f, 1.0f}), 4);
  isTurned(makeImage<double>("64FC1", 2, 2, {0.1, 0.2, 0.3, 1.0}), 8);
}

TEST(ImageCodec, RefusesASizeOutOfRange) {
  for (const int size : {0, -1, 16385}) {
    expectRefusal(makeRamp(2, 2), {"size", "[1, 16384]", "got " + std::to_string(size)}, size);
  }
}

TEST(ImageCodec, LooksAtTheCropAlone) {
  const sensor_msgs::Image image = makeRamp(6, 5);
  EXPECT_EQ(decodeImage(image, 2, {3, 1, 2, 2}), (Bytes{9, 10, 15, 16}));
  EXPECT_EQ(decodeImage(image, 3, {3, 2, 0, 0}), (Bytes{15, 16, 17, 21, 22, 23, 27, 28, 29}));
  EXPECT_EQ(decodeImage(image, 1, {0, 0, 2, 2}), (Bytes{4}));  // the mean of 0, 1, 6 and 7
}

TEST(ImageCodec, RefusesACropThatReachesBeyondTheImage) {
  const sensor_msgs::Image image = makeRamp(6, 5);
  for (const ImageCrop& crop :
       {ImageCrop{4, 0, 3, 2}, ImageCrop{0, 4, 2, 2}, ImageCrop{-1, 0, 2, 2}, ImageCrop{6, 0, 0, 0},
        ImageCrop{0, 0, 2, -1}}) {
    expectRefusal(image, {"crop", "column " + std::to_string(crop.x), "6 x 5"}, 2, crop);
  }
}

}  // namespace
}  // namespace ddm
