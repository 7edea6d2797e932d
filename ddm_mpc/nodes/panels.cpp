// Images of the model side by side, each with a caption.
// SPDX-License-Identifier: BSD-3-Clause
#include "panels.h"

#include <opencv2/imgproc.hpp>

namespace ddm {
namespace {

constexpr int kMinPanel = 255;  // [pixels]
const cv::Scalar kSeparatorGrey(128);
const cv::Scalar kCaptionGrey(220);

}  // namespace

int panelSize(int image_size) { return (kMinPanel + image_size - 1) / image_size * image_size; }

cv::Mat drawPanels(const std::vector<Panel>& panels, int image_size) {
  const int size = panelSize(image_size);
  const int count = static_cast<int>(panels.size());
  cv::Mat picture(size + kPanelCaption, count * size + (count - 1) * kPanelSeparator, CV_8UC1,
                  cv::Scalar(0));
  for (int i = 0; i < count; ++i) {
    const int left = i * (size + kPanelSeparator);
    if (i > 0) picture.colRange(left - kPanelSeparator, left).setTo(kSeparatorGrey);
    cv::putText(picture, panels[i].caption, {left + 6, size + kPanelCaption - 7},
                cv::FONT_HERSHEY_SIMPLEX, 0.5, kCaptionGrey, 1, cv::LINE_AA);
    if (panels[i].grey.empty()) continue;
    Grey grey = panels[i].grey;  // cv::Mat takes no const pixels
    const cv::Mat image(image_size, image_size, CV_8UC1, grey.data());
    cv::resize(image, picture(cv::Rect(left, 0, size, size)), cv::Size(size, size), 0.0, 0.0,
               cv::INTER_NEAREST);
  }
  return picture;
}

}  // namespace ddm
