// Images of the model side by side, each with a caption.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace ddm {

struct Panel {
  Grey grey;  ///< empty: the panel stays black
  std::string caption;
};

constexpr int kPanelSeparator = 3;  ///< between two panels [pixels]
constexpr int kPanelCaption = 24;   ///< height of the captions, below the panels [pixels]

/// Width and height of a panel: as many whole times the image as make it 255 pixels or more.
inline int panelSize(int image_size) { return (255 + image_size - 1) / image_size * image_size; }

/// @param panels  at least one, with images of image_size x image_size
/// @return        8 bit grey
inline cv::Mat drawPanels(const std::vector<Panel>& panels, int image_size) {
  const cv::Scalar separator_grey(128), caption_grey(220);
  const int size = panelSize(image_size);
  const int count = static_cast<int>(panels.size());
  cv::Mat picture(size + kPanelCaption, count * size + (count - 1) * kPanelSeparator, CV_8UC1,
                  cv::Scalar(0));
  for (int i = 0; i < count; ++i) {
    const int left = i * (size + kPanelSeparator);
    if (i > 0) picture.colRange(left - kPanelSeparator, left).setTo(separator_grey);
    cv::putText(picture, panels[i].caption, {left + 6, size + kPanelCaption - 7},
                cv::FONT_HERSHEY_SIMPLEX, 0.5, caption_grey, 1, cv::LINE_AA);
    if (panels[i].grey.empty()) continue;
    Grey grey = panels[i].grey;  // cv::Mat takes no const pixels
    const cv::Mat image(image_size, image_size, CV_8UC1, grey.data());
    cv::resize(image, picture(cv::Rect(left, 0, size, size)), cv::Size(size, size), 0.0, 0.0,
               cv::INTER_NEAREST);
  }
  return picture;
}

}  // namespace ddm
