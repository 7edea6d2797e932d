// Picture of the feature space: a grid of decoded images and what has been, is and shall be in it.
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_plane.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace ddm {
namespace {

const cv::Scalar kMargin(64, 64, 64);
const cv::Scalar kText(220, 220, 220);
const cv::Scalar kOutline(0, 0, 0);
const cv::Scalar kGreen(0, 200, 0);
const cv::Scalar kYellow(255, 255, 0);
const cv::Scalar kRed(255, 0, 0);
const cv::Scalar kCyan(0, 255, 255);

constexpr int kSmallDot = 2;
constexpr int kPlanDot = 3;
constexpr int kLargeDot = 6;
constexpr double kFarthest = 10.0;  // well outside, and small enough for OpenCV's integers

/// The outline keeps a dot visible on black, on white and on other dots.
void drawDot(const cv::Point& at, int radius, const cv::Scalar& colour, cv::Mat* picture) {
  cv::circle(*picture, at, radius + 1, kOutline, cv::FILLED);
  cv::circle(*picture, at, radius, colour, cv::FILLED);
}

void drawText(const std::string& text, const cv::Point& at, const cv::Scalar& colour,
              cv::Mat* picture) {
  cv::putText(*picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv::LINE_AA);
}

/// What the colours mean, in the margin below the grid; names of the axes.
void drawLegend(cv::Mat* picture) {
  const int baseline = FeaturePlane::kWidth - 20;
  drawText("experience", {86, baseline}, kGreen, picture);
  drawText("current", {216, baseline}, kCyan, picture);
  drawText("plan", {320, baseline}, kYellow, picture);
  drawText("goal", {404, baseline}, kRed, picture);
  drawText("z1", {FeaturePlane::kWidth - 40, FeaturePlane::kWidth / 2 + 5}, kText, picture);
  drawText("z2", {FeaturePlane::kWidth / 2 - 8, 30}, kText, picture);
}

}  // namespace

FeaturePlane::FeaturePlane(const Ddm& model) : grid_(kWidth, kWidth, CV_8UC3, kMargin) {
  Eigen::VectorXd z =
      model.hasGoal() ? model.goalFeature() : Eigen::VectorXd::Zero(model.featureDim());
  const int rows = z.size() == 1 ? 1 : kGrid;
  const double step = 2.0 / (kGrid - 1);
  for (int row = 0; row < rows; ++row) {
    if (rows > 1) z[1] = 1.0 - step * row;
    for (int column = 0; column < kGrid; ++column) {
      z[0] = -1.0 + step * column;
      Grey grey = model.decode(z);
      const cv::Mat image(model.imageSize(), model.imageSize(), CV_8UC1, grey.data());
      cv::Mat resized;
      cv::resize(image, resized, cv::Size(kPitch, kPitch), 0.0, 0.0, cv::INTER_AREA);
      const cv::Point corner = pixelOf(z) - cv::Point(kPitch / 2, kPitch / 2);
      cv::cvtColor(resized, grid_(cv::Rect(corner, resized.size())), cv::COLOR_GRAY2RGB);
    }
  }
  drawLegend(&grid_);
}

cv::Point FeaturePlane::pixelOf(const Eigen::Ref<const Eigen::VectorXd>& z) {
  const auto offset = [](double value) {
    return static_cast<int>(std::lround(kUnit * std::min(kFarthest, std::max(-kFarthest, value))));
  };
  return {kWidth / 2 + offset(z[0]), kWidth / 2 - (z.size() > 1 ? offset(z[1]) : 0)};
}

cv::Mat FeaturePlane::draw(const FeatureOverlay& overlay) const {
  cv::Mat picture = grid_.clone();
  for (Eigen::Index i = 0; i < overlay.experience.cols(); ++i) {
    cv::circle(picture, pixelOf(overlay.experience.col(i)), kSmallDot, kGreen, cv::FILLED);
  }
  for (Eigen::Index k = 1; k < overlay.plan.cols(); ++k) {
    cv::line(picture, pixelOf(overlay.plan.col(k - 1)), pixelOf(overlay.plan.col(k)), kYellow, 2,
             cv::LINE_AA);
  }
  for (Eigen::Index k = 0; k < overlay.plan.cols(); ++k) {
    drawDot(pixelOf(overlay.plan.col(k)), kPlanDot, kYellow, &picture);
  }
  for (Eigen::Index i = 0; i < overlay.goal.cols(); ++i) {
    drawDot(pixelOf(overlay.goal.col(i)), kLargeDot, kRed, &picture);
  }
  for (Eigen::Index i = 0; i < overlay.current.cols(); ++i) {
    drawDot(pixelOf(overlay.current.col(i)), kLargeDot, kCyan, &picture);
  }
  return picture;
}

}  // namespace ddm
