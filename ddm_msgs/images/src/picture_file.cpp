// Images as pictures in files.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_images/picture_file.h"

#include <cv_bridge/cv_bridge.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

namespace ddm {

sensor_msgs::Image readPicture(const std::string& path) {
  const cv::Mat grey = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (grey.empty()) {
    throw std::invalid_argument(path + " cannot be read as an image: give a PNG or PGM file");
  }
  return *cv_bridge::CvImage(std_msgs::Header(), "mono8", grey).toImageMsg();
}

void writePicture(const std::string& path, const sensor_msgs::Image& image) {
  const char* encoding = image.encoding == "mono8" ? "mono8" : "bgr8";  // as OpenCV writes colours
  bool written = false;
  try {
    written = cv::imwrite(path, cv_bridge::toCvCopy(image, encoding)->image);
  } catch (const cv::Exception&) {  // the path below says more than its text
  }
  if (!written) {
    throw std::runtime_error(path + " cannot be written; check the folder and its disk");
  }
}

}  // namespace ddm
