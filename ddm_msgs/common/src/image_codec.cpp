// Converts camera messages to grey values: checks, then grey, crop, square, size.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/image_codec.h"

#include <cv_bridge/cv_bridge.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/plain_file.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

namespace ddm {
namespace {

namespace encodings = sensor_msgs::image_encodings;

constexpr int kMaxSize = 16384;

// YUV 4:2:2 has two bytes per pixel; one of them is the luma.
constexpr char kLumaFirst[] = "yuyv";
constexpr char kLumaSecond[] = "uyvy";

/// Accepted encodings in lower case, each with the encoding by which its pixels are read.
const std::map<std::string, std::string>& acceptedEncodings() {
  static const std::map<std::string, std::string> accepted = [] {
    // OpenCV's own names do not specify colours, and cv_bridge refuses to convert them to grey.
    // Drivers use many names for the two byte orders of YUV 4:2:2: luma first, or luma second
    // (yuv422 in ROS).
    std::map<std::string, std::string> out = {
        {"8uc1", "mono8"},           {"8uc3", "bgr8"},        {"8uc4", "bgra8"},
        {"16uc1", "mono16"},         {"16uc3", "bgr16"},      {"16uc4", "bgra16"},
        {"32fc1", "32FC1"},          {"64fc1", "64FC1"},      {"yuyv", kLumaFirst},
        {"yuy2", kLumaFirst},        {"yuyv422", kLumaFirst}, {"yuv422_yuy2", kLumaFirst},
        {"yuv422", kLumaSecond},     {"uyvy", kLumaSecond},   {"uyvy422", kLumaSecond},
        {"yuv422_uyvy", kLumaSecond}};
    for (const char* layout : {"mono", "rgb", "bgr", "rgba", "bgra", "bayer_rggb", "bayer_bggr",
                               "bayer_gbrg", "bayer_grbg"}) {
      for (const char* bits : {"8", "16"}) {
        out[std::string(layout) + bits] = std::string(layout) + bits;
      }
    }
    return out;
  }();
  return accepted;
}

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw std::invalid_argument(textOf("image: ", parts...));
}

void requireSize(int size) {
  if (size < 1 || size > kMaxSize) {
    refuse("size must lie in [1, ", kMaxSize, "], got ", size);
  }
}

std::string extent(const sensor_msgs::Image& image) {
  return textOf(image.width, " x ", image.height, " ", image.encoding);
}

bool isYuv422(const std::string& encoding) {
  return encoding == kLumaFirst || encoding == kLumaSecond;
}

std::size_t depthBytes(const std::string& encoding) {
  return isYuv422(encoding) ? 1 : encodings::bitDepth(encoding) / 8;
}

/// Returns the encoding by which the pixels are read. Throws unless every pixel lies within the
/// data.
std::string checkedEncoding(const sensor_msgs::Image& image) {
  const auto found = acceptedEncodings().find(boost::algorithm::to_lower_copy(image.encoding));
  if (found == acceptedEncodings().end()) {
    std::string known;
    for (const auto& entry : acceptedEncodings()) known += " " + entry.first;
    refuse("unknown encoding '", image.encoding, "', known are", known,
           ": record one of them, for instance with image_proc");
  }
  if (image.width < 1 || image.height < 1 || image.width > kMaxSize || image.height > kMaxSize) {
    refuse("width and height must lie in [1, ", kMaxSize, "], got ", extent(image));
  }
  const std::string& encoding = found->second;
  const std::size_t channels = isYuv422(encoding) ? 2 : encodings::numChannels(encoding);
  const std::size_t row_bytes = image.width * depthBytes(encoding) * channels;
  if (image.step < row_bytes) {
    refuse("step must be at least ", row_bytes, " bytes for ", extent(image), ", got ", image.step);
  }
  const std::size_t data_bytes = std::size_t{image.step} * image.height;
  if (image.data.size() != data_bytes) {
    refuse("data must hold step * height = ", data_bytes, " bytes for ", extent(image), ", got ",
           image.data.size());
  }
  // OpenCV returns a black image for a mosaic that is smaller than its filter.
  if (encodings::isBayer(encoding) && (image.width < 3 || image.height < 3)) {
    refuse("a Bayer mosaic needs at least 3 x 3 pixels, got ", extent(image));
  }
  if (isYuv422(encoding) && image.width % 2 != 0) {
    refuse("YUV 4:2:2 needs an even width, got ", extent(image));
  }
  return encoding;
}

template <class Real>
void requireUnitRange(const cv::Mat& grey) {
  for (int row = 0; row < grey.rows; ++row) {
    for (int col = 0; col < grey.cols; ++col) {
      const Real value = grey.at<Real>(row, col);
      if (value >= Real{0} && value <= Real{1}) continue;  // false for NaN
      refuse("float grey values must lie in [0, 1], got ", value, " at row ", row, ", column ", col,
             "; scale them, for instance a depth, before they are recorded");
    }
  }
}

/// Converts the pixels to the byte order of this computer. cv_bridge would treat their bytes as
/// channels.
void swapBytes(std::size_t depth_bytes, sensor_msgs::Image* image) {
  for (std::size_t row = 0; row < image->data.size(); row += image->step) {
    for (std::size_t at = 0; at + depth_bytes <= image->step; at += depth_bytes) {
      std::uint8_t* const value = &image->data[row + at];
      std::reverse(value, value + depth_bytes);
    }
  }
  image->is_bigendian = 0;
}

/// Converts the image to one channel with the depth of the image.
cv::Mat greyImage(const sensor_msgs::Image& image, const std::string& encoding) {
  if (isYuv422(encoding)) {
    // cv::Mat has no constructor for constant pixels. The pixels are only read.
    const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC2,
                         const_cast<std::uint8_t*>(image.data.data()), image.step);
    cv::Mat luma;
    cv::extractChannel(pixels, luma, encoding == kLumaFirst ? 0 : 1);
    return luma;
  }
  sensor_msgs::Image named = image;
  named.encoding = encoding;
  if (image.is_bigendian) swapBytes(depthBytes(encoding), &named);
  const cv_bridge::CvImagePtr pixels = cv_bridge::toCvCopy(named);
  const int depth = pixels->image.depth();
  if (depth == CV_32F) requireUnitRange<float>(pixels->image);
  if (depth == CV_64F) requireUnitRange<double>(pixels->image);
  if (depth == CV_32F || depth == CV_64F) return pixels->image;
  return cv_bridge::cvtColor(pixels, depth == CV_16U ? "mono16" : "mono8")->image;
}

cv::Mat cropped(const cv::Mat& grey, const ImageCrop& crop) {
  const int width = crop.width == 0 ? grey.cols - crop.x : crop.width;
  const int height = crop.height == 0 ? grey.rows - crop.y : crop.height;
  const cv::Rect rectangle(crop.x, crop.y, width, height);
  if (crop.x < 0 || crop.y < 0 || width < 1 || height < 1 ||
      (rectangle & cv::Rect(0, 0, grey.cols, grey.rows)) != rectangle) {
    refuse("the crop of ", width, " x ", height, " pixels from column ", crop.x, ", row ", crop.y,
           " on must lie within the image's ", grey.cols, " x ", grey.rows);
  }
  return grey(rectangle);
}

cv::Mat centralSquare(const cv::Mat& grey) {
  const int side = std::min(grey.cols, grey.rows);
  return grey(cv::Rect((grey.cols - side) / 2, (grey.rows - side) / 2, side, side));
}

double greyScale(int depth) {
  if (depth == CV_8U) return 1.0;
  if (depth == CV_16U) return 1.0 / 257.0;
  return 255.0;
}

/// Whether a JPEG is truncated; OpenCV fills missing parts with grey. The search for the end marker
/// begins after the headers, because the headers may contain a smaller JPEG.
bool isJpegCutShort(const std::vector<std::uint8_t>& data) {
  constexpr std::uint8_t kMark = 0xff, kBegin = 0xd8, kScan = 0xda, kEnd = 0xd9;
  if (data.size() < 2 || data[0] != kMark || data[1] != kBegin) return false;
  std::size_t at = 2;
  while (at + 4 <= data.size() && data[at] == kMark && data[at + 1] != kScan) {
    at += data[at + 1] == kMark ? 1 : 2 + 256U * data[at + 2] + data[at + 3];  // 1: a fill byte
  }
  const std::uint8_t end[] = {kMark, kEnd};
  return at >= data.size() || std::search(data.begin() + static_cast<std::ptrdiff_t>(at),
                                          data.end(), end, end + 2) == data.end();
}

}  // namespace

std::vector<std::uint8_t> decodeImage(const sensor_msgs::Image& image, int size,
                                      const ImageCrop& crop) {
  requireSize(size);
  const std::string encoding = checkedEncoding(image);
  const auto side = static_cast<std::uint32_t>(size);
  const bool whole = crop.x == 0 && crop.y == 0 && crop.width == 0 && crop.height == 0;
  if (whole && encoding == "mono8" && image.width == side && image.height == side &&
      image.step == side) {
    return image.data;
  }
  cv::Mat grey;
  try {
    grey = centralSquare(cropped(greyImage(image, encoding), crop));
    if (grey.rows != size) cv::resize(grey, grey, cv::Size(size, size), 0, 0, cv::INTER_AREA);
  } catch (const std::invalid_argument&) {  // from refuse()
    throw;
  } catch (const std::exception& e) {
    refuse("cannot convert ", extent(image), " to grey: ", e.what());
  }
  const double scale = greyScale(grey.depth());
  grey.convertTo(grey, CV_64F);
  std::vector<std::uint8_t> out;
  out.reserve(grey.total());
  for (int row = 0; row < size; ++row) {
    for (int col = 0; col < size; ++col) {
      const double value = std::round(scale * grey.at<double>(row, col));
      out.push_back(static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, value))));
    }
  }
  return out;
}

sensor_msgs::Image unpacked(const sensor_msgs::CompressedImage& image) {
  const bool cut_short = isJpegCutShort(image.data);
  cv::Mat pixels;
  try {
    if (!image.data.empty() && !cut_short) {
      pixels = cv::imdecode(image.data, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
    }
  } catch (const cv::Exception&) {  // the message below is more helpful than OpenCV's
  }
  if (pixels.empty() || (pixels.depth() != CV_8U && pixels.depth() != CV_16U)) {
    refuse(image.data.size(), " bytes of format '", image.format, "' cannot be unpacked",
           cut_short ? ", since they end early" : "", ": record JPEG or PNG");
  }
  const char* encoding = pixels.depth() == CV_16U ? "bgr16" : "bgr8";
  return *cv_bridge::CvImage(image.header, encoding, pixels).toImageMsg();
}

sensor_msgs::Image encodeImage(const std::vector<std::uint8_t>& grey, int size,
                               const ros::Time& stamp, const std::string& frame_id) {
  requireSize(size);
  const auto side = static_cast<std::uint32_t>(size);
  const std::size_t count = std::size_t{side} * side;
  if (grey.size() != count) {
    refuse("an image of size ", size, " needs ", count, " grey values, got ", grey.size());
  }
  sensor_msgs::Image image;
  image.header.stamp = stamp;
  image.header.frame_id = frame_id;
  image.width = side;
  image.height = side;
  image.encoding = "mono8";
  image.is_bigendian = 0;
  image.step = side;
  image.data = grey;
  return image;
}

sensor_msgs::Image readImageFile(const std::string& path) {
  requirePlainFile(path);
  const cv::Mat grey = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) {
    throw std::invalid_argument(path + " cannot be read as an image: give a PNG or PGM file");
  }
  return *cv_bridge::CvImage(std_msgs::Header(), "mono8", grey).toImageMsg();
}

void writeImageFile(const std::string& path, const sensor_msgs::Image& image) {
  // OpenCV writes colours in the order blue, green, red.
  const char* encoding = image.encoding == "mono8" ? "mono8" : "bgr8";
  std::vector<std::uint8_t> bytes;
  try {
    cv::imencode(std::filesystem::path(path).extension().string(),
                 cv_bridge::toCvCopy(image, encoding)->image, bytes);
  } catch (const cv::Exception&) {
    throw std::runtime_error(path + " cannot be written: end its name in .png or .pgm");
  }
  writeFileAtomically(path, std::string(bytes.begin(), bytes.end()));
}

}  // namespace ddm
