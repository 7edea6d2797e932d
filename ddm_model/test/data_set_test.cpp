// Tests of the data set: segments, seams, refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/data_set.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

using testing::throwsNaming;

Eigen::VectorXd torque(double value) { return Eigen::VectorXd::Constant(1, value); }

/// Frames of 2 x 2 pixels that all have the grey value and torque of their index.
DataSet numbered(int first, int count) {
  DataSet data(2, 1);
  for (int i = first; i < first + count; ++i) {
    data.append(Image(4, static_cast<std::uint8_t>(i)), torque(i), i == first);
  }
  return data;
}

TEST(DataSet, GivesImagesSideBySideTheGoalLast) {
  DataSet data = numbered(0, 3);
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

TEST(DataSet, KeepsASeamBetweenTwoTrials) {
  DataSet data = numbered(0, 3);
  data.append(numbered(10, 2));
  ASSERT_EQ(data.numFrames(), 5);
  ASSERT_EQ(data.segments().size(), 2U);
  EXPECT_EQ(data.segments()[1].begin, 3);
  EXPECT_EQ(data.segments()[1].size, 2);
  EXPECT_EQ(data.image(3)[0], 10);
  EXPECT_EQ(data.torques()(0, 4), 11.0);
}

TEST(DataSet, TheLastGoalThatIsAppendedCounts) {
  DataSet with_goal = numbered(0, 1);
  with_goal.setGoal(Image(4, 9));
  DataSet data = numbered(0, 1);
  EXPECT_FALSE(data.hasGoal());
  data.append(with_goal);
  EXPECT_EQ(data.goal(), Image(4, 9));
  DataSet other = numbered(0, 1);
  other.setGoal(Image(4, 7));
  data.append(other);
  EXPECT_EQ(data.goal(), Image(4, 7));
  data.append(numbered(0, 1));
  EXPECT_EQ(data.goal(), Image(4, 7));
}

TEST(DataSet, RefusesFramesAndDataSetsThatDoNotFit) {
  DataSet data(2, 1);
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { data.append(Image(5), torque(0), true); },
                                                  {"4 pixels", "got 5"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { data.append(Image(4), Eigen::Vector2d(0, 0), true); }, {"1 value", "got 2"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { data.append(Image(4), torque(std::numeric_limits<double>::quiet_NaN()), true); },
      {"finite"}));
  EXPECT_TRUE(
      throwsNaming<std::invalid_argument>([&] { data.setGoal(Image(3)); }, {"4 pixels", "got 3"}));
  EXPECT_EQ(data.numFrames(), 0);  // nothing of a refused frame is kept
  EXPECT_TRUE(data.segments().empty());
  EXPECT_THROW(data.append(DataSet(3, 1)), std::invalid_argument);
  EXPECT_THROW(data.append(DataSet(2, 2)), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
