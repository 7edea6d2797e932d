// Tests of the captions under the images of the model.
// SPDX-License-Identifier: BSD-3-Clause
#include "panels.h"

#include <gtest/gtest.h>

#include "random_model.h"

namespace ddm {
namespace {

TEST(Panels, HaveACaptionEachThatTouchesNoImage) {
  const Grey black(64, 0);
  const cv::Mat picture = drawPanels({{black, "camera"}, {{}, ""}, {black, "prediction"}}, 8);
  const int size = panelSize(8), pitch = size + kPanelSeparator;
  ASSERT_EQ(picture.size(), cv::Size(3 * pitch - kPanelSeparator, size + kPanelCaption));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cv::countNonZero(picture(cv::Rect(i * pitch, 0, size, size))), 0);
    const int caption = cv::countNonZero(picture(cv::Rect(i * pitch, size, size, kPanelCaption)));
    EXPECT_EQ(caption > 100, i != 1) << caption;
  }
}

TEST(Panels, AreAWholeTimesAsLargeAsTheImage) {
  EXPECT_EQ(panelSize(51), 255);
  EXPECT_EQ(panelSize(8), 256);
  EXPECT_EQ(panelSize(300), 300);
}

}  // namespace
}  // namespace ddm
