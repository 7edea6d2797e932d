// Images of the model side by side, each with a caption.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <opencv2/core.hpp>
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
int panelSize(int image_size);

/// @param panels  at least one, with images of image_size x image_size
/// @return        8 bit grey
cv::Mat drawPanels(const std::vector<Panel>& panels, int image_size);

}  // namespace ddm
