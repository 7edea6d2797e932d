// Tests of the data set: goal images.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/data_set.h"

#include <gtest/gtest.h>

namespace ddm {
namespace {

/// Frames of 2 x 2 pixels that all have the grey value and torque of their index.
DataSet numbered(int count) {
  DataSet data(2, 1);
  for (int i = 0; i < count; ++i) {
    data.append(Image(4, static_cast<std::uint8_t>(i)), Eigen::VectorXd::Constant(1, i), i == 0);
  }
  return data;
}

TEST(DataSet, GivesImagesSideBySideTheGoalLast) {
  DataSet data = numbered(3);
  EXPECT_EQ(data.numImages(), 3);
  data.setGoal({9, 8, 7, 6});
  ASSERT_EQ(data.numImages(), 4);
  EXPECT_EQ(data.image(3), data.goal());
  const ImageMatrix pixels = data.pixels(2, 2);
  ASSERT_EQ(pixels.cols(), 2);
  for (Eigen::Index k = 0; k < 4; ++k) {
    EXPECT_EQ(pixels(k, 0), data.image(2)[static_cast<size_t>(k)]);
    EXPECT_EQ(pixels(k, 1), 9 - k);
  }
}

TEST(DataSet, TheLastGoalThatIsAppendedCounts) {
  DataSet data = numbered(1);
  EXPECT_FALSE(data.hasGoal());
  for (const std::uint8_t grey : {9, 7}) {
    DataSet with_goal = numbered(1);
    with_goal.setGoal(Image(4, grey));
    data.append(with_goal);
    EXPECT_EQ(data.goal(), Image(4, grey));
  }
  data.append(numbered(1));
  EXPECT_EQ(data.goal(), Image(4, 7));
}

}  // namespace
}  // namespace ddm
