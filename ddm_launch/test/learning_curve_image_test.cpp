// Tests of the learning curve as a picture: marks and their places, with and without ground truth.
// SPDX-License-Identifier: BSD-3-Clause
#include "learning_curve_image.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "toy_run.h"

namespace ddm {
namespace {

using testing::kToySteps;
using testing::toyRow;

constexpr double kGoalDeg = 10.0;
const cv::Scalar kBlue(0, 114, 178);
const cv::Scalar kRed(213, 94, 0);
const cv::Scalar kOrange(230, 159, 0);

TrialRow rowWith(int trial, double error_deg, bool success) {
  TrialRow row = toyRow(trial);
  row.evaluation.final_error_deg = error_deg;
  row.evaluation.success = success;
  return row;
}

/// Where pixels of exactly this colour are.
cv::Mat mask(const cv::Mat& picture, const cv::Scalar& colour) {
  cv::Mat found;
  cv::inRange(picture, colour, colour, found);
  return found;
}

int count(const cv::Mat& picture, const cv::Scalar& colour) {
  return cv::countNonZero(mask(picture, colour));
}

cv::Point2d middle(const cv::Mat& picture, const cv::Scalar& colour) {
  const cv::Moments moments = cv::moments(mask(picture, colour), /*binaryImage=*/true);
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

TEST(LearningCurveImage, MarksSuccessWithABlueDotAndFailureWithARedCross) {
  const cv::Mat success = drawLearningCurve({rowWith(0, 5.0, true)}, 300, kGoalDeg);
  EXPECT_GT(count(success, kBlue), 50);
  EXPECT_EQ(count(success, kRed), 0);
  const cv::Mat failure = drawLearningCurve({rowWith(0, 90.0, false)}, 300, kGoalDeg);
  EXPECT_EQ(count(failure, kBlue), 0);
  EXPECT_GT(count(failure, kRed), 30);
}

TEST(LearningCurveImage, PutsLargeErrorsHighAndManyFramesToTheRight) {
  const auto at = [](int trial, double error_deg) {
    return middle(drawLearningCurve({rowWith(trial, error_deg, true)}, 10 * kToySteps, kGoalDeg),
                  kBlue);
  };
  EXPECT_NEAR(at(0, 180.0).y, 34.0, 1.0) << "upper edge";
  EXPECT_NEAR(at(0, 0.0).y, 34.0 + 218.0, 1.0) << "lower edge";
  EXPECT_NEAR(at(0, 90.0).y, 34.0 + 109.0, 1.0);
  EXPECT_NEAR(at(4, 90.0).x, 58.0 + 275.0, 1.0) << "half of the frames";
  EXPECT_NEAR(at(9, 90.0).x, 58.0 + 550.0, 1.0) << "all of them";
}

TEST(LearningCurveImage, GrowsTrialByTrialAndLeavesWhatWasThere) {
  std::vector<TrialRow> rows;
  int marks = 0;
  for (int trial = 0; trial < 5; ++trial) {
    rows.push_back(rowWith(trial, 30.0 * trial, true));
    const int now = count(drawLearningCurve(rows, 5 * kToySteps, kGoalDeg), kBlue);
    EXPECT_GT(now, marks + 30) << "trial " << trial;
    marks = now;
  }
}

TEST(LearningCurveImage, HasARowOfDotsAndARowOfCrossesWhereFeaturesAreTheJudge) {
  std::vector<TrialRow> rows = {rowWith(0, 0.0, false), rowWith(4, 0.0, true)};
  for (TrialRow& row : rows) row.evaluation.final_error_deg = std::nullopt;
  const cv::Mat picture = drawLearningCurve(rows, 10 * kToySteps, kGoalDeg);
  EXPECT_GT(middle(picture, kBlue).y, middle(picture, kRed).y + 100.0);
  EXPECT_GT(middle(picture, kBlue).x, middle(picture, kRed).x + 100.0);
}

TEST(LearningCurveImage, ShowsTheErrorsOfTheModelWhereNobodyKnowsTheTruth) {
  TrialRow row = toyRow(1);
  row.evaluation = Evaluation();
  const cv::Mat picture = drawLearningCurve({row}, 300, kGoalDeg);
  EXPECT_EQ(count(picture, kBlue) + count(picture, kRed), 0);
  EXPECT_GT(count(picture, kOrange), 10);
}

TEST(LearningCurveImage, IsAnEmptyFrameBeforeTheFirstTrialAndForAMethodWithoutErrors) {
  EXPECT_EQ(drawLearningCurve({}, 300, kGoalDeg).size(), cv::Size(640, 480));
  TrialRow row = toyRow(0);
  row.v_r.reset();
  row.v_p.reset();
  EXPECT_GT(count(drawLearningCurve({row}, 0, kGoalDeg), kRed), 30);
}

}  // namespace
}  // namespace ddm
