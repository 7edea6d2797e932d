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

const cv::Scalar kBlue(0, 114, 178);
const cv::Scalar kRed(213, 94, 0);
const cv::Scalar kOrange(230, 159, 0);

EvaluationOptions inDegrees() {
  EvaluationOptions options;
  options.tolerance = 10.0;
  options.error_unit = "deg";
  return options;
}

TrialRow rowWith(int trial, double error, bool success) {
  TrialRow row = toyRow(trial);
  row.evaluation.final_error = error;
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
  const cv::Mat success = drawLearningCurve({rowWith(0, 5.0, true)}, 300, inDegrees());
  EXPECT_GT(count(success, kBlue), 50);
  EXPECT_EQ(count(success, kRed), 0);
  const cv::Mat failure = drawLearningCurve({rowWith(0, 90.0, false)}, 300, inDegrees());
  EXPECT_EQ(count(failure, kBlue), 0);
  EXPECT_GT(count(failure, kRed), 30);
}

TEST(LearningCurveImage, PutsLargeErrorsHighAndManyFramesToTheRight) {
  // The cross of a failure at 180 sets the scale.
  const auto at = [](int trial, double error) {
    const std::vector<TrialRow> rows = {rowWith(0, 180.0, false), rowWith(trial, error, true)};
    return middle(drawLearningCurve(rows, 10 * kToySteps, inDegrees()), kBlue);
  };
  EXPECT_NEAR(at(1, 180.0).y, 34.0, 1.0) << "upper edge";
  EXPECT_NEAR(at(1, 0.0).y, 34.0 + 218.0, 1.0) << "lower edge";
  EXPECT_NEAR(at(1, 90.0).y, 34.0 + 109.0, 1.0);
  EXPECT_NEAR(at(4, 90.0).x, 58.0 + 275.0, 1.0) << "half of the frames";
  EXPECT_NEAR(at(9, 90.0).x, 58.0 + 550.0, 1.0) << "all of them";
}

TEST(LearningCurveImage, ReachesUpToTheLargestErrorOrTwiceTheTolerance) {
  EvaluationOptions in_metres;
  in_metres.tolerance = 0.05;
  in_metres.error_unit = "m";
  const auto height = [&](double error) {
    const cv::Mat picture = drawLearningCurve({rowWith(4, error, true)}, 300, in_metres);
    return middle(picture, kBlue).y;
  };
  EXPECT_NEAR(height(0.05), 34.0 + 109.0, 1.0);
  EXPECT_NEAR(height(0.025), 34.0 + 163.5, 1.0);
  EXPECT_NEAR(height(3.0), 34.0, 1.0);
}

TEST(LearningCurveImage, GrowsTrialByTrialAndLeavesWhatWasThere) {
  std::vector<TrialRow> rows;
  int marks = 0;
  for (int trial = 0; trial < 5; ++trial) {
    rows.push_back(rowWith(trial, 30.0 * trial, true));
    const int now = count(drawLearningCurve(rows, 5 * kToySteps, inDegrees()), kBlue);
    EXPECT_GT(now, marks + 30) << "trial " << trial;
    marks = now;
  }
}

TEST(LearningCurveImage, HasARowOfDotsAndARowOfCrossesWhereFeaturesAreTheJudge) {
  std::vector<TrialRow> rows = {rowWith(0, 0.0, false), rowWith(4, 0.0, true)};
  for (TrialRow& row : rows) row.evaluation.final_error = std::nullopt;
  const cv::Mat picture = drawLearningCurve(rows, 10 * kToySteps, inDegrees());
  EXPECT_GT(middle(picture, kBlue).y, middle(picture, kRed).y + 100.0);
  EXPECT_GT(middle(picture, kBlue).x, middle(picture, kRed).x + 100.0);
}

TEST(LearningCurveImage, ShowsTheErrorsOfTheModelWhereNobodyKnowsTheTruth) {
  TrialRow row = toyRow(1);
  row.evaluation = Evaluation();
  const cv::Mat picture = drawLearningCurve({row}, 300, inDegrees());
  EXPECT_EQ(count(picture, kBlue) + count(picture, kRed), 0);
  EXPECT_GT(count(picture, kOrange), 10);
}

TEST(LearningCurveImage, IsAnEmptyFrameBeforeTheFirstTrialAndForAMethodWithoutErrors) {
  EXPECT_EQ(drawLearningCurve({}, 300, inDegrees()).size(), cv::Size(640, 480));
  TrialRow row = toyRow(0);
  row.v_r.reset();
  row.v_p.reset();
  EXPECT_GT(count(drawLearningCurve({row}, 0, inDegrees()), kRed), 30);
}

}  // namespace
}  // namespace ddm
