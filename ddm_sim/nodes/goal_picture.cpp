// The goal as a picture in a file.
// SPDX-License-Identifier: BSD-3-Clause
#include "goal_picture.h"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace ddm {

bool goalPictureExists(const std::string& path) { return std::filesystem::exists(path); }

sensor_msgs::Image readGoalPicture(const std::string& path) {
  const cv::Mat grey = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) {
    throw std::invalid_argument("goal " + path +
                                " is not a picture that can be read: give a PNG or PGM file");
  }
  sensor_msgs::Image image;
  image.width = static_cast<std::uint32_t>(grey.cols);
  image.height = static_cast<std::uint32_t>(grey.rows);
  image.step = image.width;
  image.encoding = "mono8";
  for (int row = 0; row < grey.rows; ++row) {
    image.data.insert(image.data.end(), grey.ptr(row), grey.ptr(row) + grey.cols);
  }
  return image;
}

void writeGoalPicture(const std::string& path, const sensor_msgs::Image& goal) {
  cv::Mat grey(static_cast<int>(goal.height), static_cast<int>(goal.width), CV_8U);
  std::copy(goal.data.begin(), goal.data.end(), grey.begin<std::uint8_t>());
  bool written = false;
  try {
    written = cv::imwrite(path, grey);
  } catch (const cv::Exception& e) {
    throw std::runtime_error("goal " + path + " cannot be written: " + e.what());
  }
  if (!written)
    throw std::runtime_error("goal " + path + " cannot be written: does its folder exist?");
}

}  // namespace ddm
