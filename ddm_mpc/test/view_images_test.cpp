// Tests of the images of view_node: where things are drawn, and in which colour.
// SPDX-License-Identifier: BSD-3-Clause
#include "view_images.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <limits>

#include "random_model.h"

namespace ddm {
namespace {

const cv::Vec3b kGreen(0, 200, 0);
const cv::Vec3b kYellow(255, 255, 0);
const cv::Vec3b kRed(255, 0, 0);
const cv::Vec3b kCyan(0, 255, 255);

RandomModelOptions featureDim(int feature_dim) {
  RandomModelOptions options;
  options.model.feature_dim = feature_dim;
  return options;
}

cv::Vec3b colourAt(const cv::Mat& drawing, const Eigen::VectorXd& z) {
  return drawing.at<cv::Vec3b>(FeaturePlane::pixelOf(z));
}

Eigen::VectorXd feature(std::initializer_list<double> values) {
  Eigen::VectorXd z(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), z.data());
  return z;
}

bool isGrey(const cv::Vec3b& colour) { return colour[0] == colour[1] && colour[1] == colour[2]; }

double meanOf(const Image& image) {
  double sum = 0.0;
  for (const std::uint8_t k : image) sum += k;
  return sum / static_cast<double>(image.size());
}

/// Mean of the image of the grid whose middle is z.
double meanAt(const cv::Mat& drawing, const Eigen::VectorXd& z) {
  const cv::Point corner =
      FeaturePlane::pixelOf(z) - cv::Point(FeaturePlane::kPitch / 2, FeaturePlane::kPitch / 2);
  return cv::mean(
      drawing(cv::Rect(corner, cv::Size(FeaturePlane::kPitch, FeaturePlane::kPitch))))[0];
}

TEST(FeaturePlane, DecodesEachPointOfTheGridWithTheFirstFeatureToTheRightAndTheSecondUpwards) {
  const cv::Point origin = FeaturePlane::pixelOf(feature({0.0, 0.0}));
  EXPECT_EQ(FeaturePlane::pixelOf(feature({1.0, 0.0})), origin + cv::Point(192, 0));
  EXPECT_EQ(FeaturePlane::pixelOf(feature({0.0, 1.0})), origin - cv::Point(0, 192));
  const Ddm model = randomModel({});
  const cv::Mat drawing = FeaturePlane(model).draw({});
  ASSERT_EQ(drawing.size(), cv::Size(FeaturePlane::kWidth, FeaturePlane::kWidth));
  for (int row = 0; row < FeaturePlane::kGrid; ++row) {
    for (int column = 0; column < FeaturePlane::kGrid; ++column) {
      const Eigen::VectorXd z = feature({-1.0 + 0.25 * column, -1.0 + 0.25 * row});
      EXPECT_NEAR(meanAt(drawing, z), meanOf(model.decode(z)), 0.51) << z.transpose();
    }
  }
}

TEST(FeaturePlane, DrawsEachPartInItsColour) {
  const FeaturePlane plane(randomModel({}));
  FeatureOverlay overlay;
  overlay.experience = feature({-0.8, 0.7});
  overlay.current = feature({0.5, 0.5});
  overlay.goal = feature({-0.5, -0.5});
  overlay.plan.resize(2, 2);
  overlay.plan << 0.1, 0.9, -0.3, -0.3;
  const cv::Mat drawing = plane.draw(overlay);
  EXPECT_EQ(colourAt(drawing, overlay.experience), kGreen);
  EXPECT_EQ(colourAt(drawing, overlay.current), kCyan);
  EXPECT_EQ(colourAt(drawing, overlay.goal), kRed);
  EXPECT_EQ(colourAt(drawing, overlay.plan.col(0)), kYellow);
  EXPECT_EQ(colourAt(drawing, overlay.plan.col(1)), kYellow);
  EXPECT_EQ(colourAt(drawing, feature({0.5, -0.3})), kYellow) << "the line between them";
  EXPECT_TRUE(isGrey(colourAt(drawing, feature({0.0, 0.8}))));
}

TEST(FeaturePlane, ShowsOneFeatureAsARowOfImages) {
  const Ddm model = randomModel(featureDim(1));
  const FeaturePlane plane(model);
  const Eigen::VectorXd z = feature({-0.5});
  EXPECT_NEAR(meanAt(plane.draw({}), z), meanOf(model.decode(z)), 0.51);
  EXPECT_EQ(FeaturePlane::pixelOf(z).y, FeaturePlane::kWidth / 2);
  FeatureOverlay overlay;
  overlay.current = z;
  EXPECT_EQ(colourAt(plane.draw(overlay), z), kCyan);
}

TEST(FeaturePlane, GivesFurtherFeaturesTheValueOfTheGoal) {
  const Ddm model = randomModel(featureDim(4));
  Eigen::VectorXd z = model.goalFeature();
  z[0] = 0.75;
  z[1] = -0.25;
  EXPECT_NEAR(meanAt(FeaturePlane(model).draw({}), z), meanOf(model.decode(z)), 0.51);
}

TEST(FeaturePlane, SurvivesFeaturesFarAwayAndFeaturesThatAreNoNumbers) {
  const FeaturePlane plane(randomModel({}));
  FeatureOverlay overlay;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  overlay.plan.resize(2, 3);
  overlay.plan << 0.0, 1e300, nan, 0.0, -1e300, nan;
  overlay.experience = overlay.plan;
  overlay.current = overlay.plan.col(1);
  EXPECT_EQ(colourAt(plane.draw(overlay), feature({0.0, 0.0})), kYellow);
}

}  // namespace
}  // namespace ddm
