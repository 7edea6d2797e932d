// Images that view_node draws: the feature space, and several images side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "view_images.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace ddm {
namespace {

const cv::Scalar kMargin(64, 64, 64);
const cv::Scalar kText(220, 220, 220);
const cv::Scalar kOutline(0, 0, 0);
const cv::Scalar kExperience(0, 200, 0);  // red, green, blue
const cv::Scalar kPlan(255, 255, 0);
const cv::Scalar kGoal(255, 0, 0);
const cv::Scalar kCurrent(0, 255, 255);

constexpr int kSmallRadius = 2;
constexpr int kPlanRadius = 3;
constexpr int kLargeRadius = 6;
// Far outside the image, yet small enough for OpenCV's integers.
constexpr double kFarthestDot = 10.0;

/// Draws a dot with an outline that keeps it visible on black, on white and on other dots.
void drawDot(const cv::Point& at, int radius, const cv::Scalar& colour, cv::Mat* drawing) {
  cv::circle(*drawing, at, radius + 1, kOutline, cv::FILLED);
  cv::circle(*drawing, at, radius, colour, cv::FILLED);
}

void drawText(const std::string& text, const cv::Point& at, const cv::Scalar& colour,
              cv::Mat* drawing) {
  cv::putText(*drawing, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv::LINE_AA);
}

/// Draws the legend of the colours below the grid, and the names of the axes.
void drawLegend(cv::Mat* drawing) {
  const int baseline = FeaturePlane::kWidth - 20;
  drawText("experience", {86, baseline}, kExperience, drawing);
  drawText("current", {216, baseline}, kCurrent, drawing);
  drawText("plan", {320, baseline}, kPlan, drawing);
  drawText("goal", {404, baseline}, kGoal, drawing);
  drawText("z1", {FeaturePlane::kWidth - 40, FeaturePlane::kWidth / 2 + 5}, kText, drawing);
  drawText("z2", {FeaturePlane::kWidth / 2 - 8, 30}, kText, drawing);
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
      Image pixels = model.decode(z);
      const cv::Mat image(model.imageSize(), model.imageSize(), CV_8UC1, pixels.data());
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
    return static_cast<int>(
        std::lround(kUnit * std::min(kFarthestDot, std::max(-kFarthestDot, value))));
  };
  return {kWidth / 2 + offset(z[0]), kWidth / 2 - (z.size() > 1 ? offset(z[1]) : 0)};
}

cv::Mat FeaturePlane::draw(const FeatureOverlay& overlay) const {
  cv::Mat drawing = grid_.clone();
  const auto drawDots = [&drawing](const Eigen::MatrixXd& Z, int radius, const cv::Scalar& colour) {
    for (Eigen::Index i = 0; i < Z.cols(); ++i)
      drawDot(pixelOf(Z.col(i)), radius, colour, &drawing);
  };
  for (Eigen::Index i = 0; i < overlay.experience.cols(); ++i) {
    cv::circle(drawing, pixelOf(overlay.experience.col(i)), kSmallRadius, kExperience, cv::FILLED);
  }
  for (Eigen::Index k = 1; k < overlay.plan.cols(); ++k) {
    cv::line(drawing, pixelOf(overlay.plan.col(k - 1)), pixelOf(overlay.plan.col(k)), kPlan, 2,
             cv::LINE_AA);
  }
  drawDots(overlay.plan, kPlanRadius, kPlan);
  drawDots(overlay.goal, kLargeRadius, kGoal);
  drawDots(overlay.current, kLargeRadius, kCurrent);
  return drawing;
}

cv::Mat drawPanels(const std::vector<Panel>& panels, int image_size) {
  const cv::Scalar separator_grey(128), caption_grey(220);
  const int size = panelSize(image_size);
  const int count = static_cast<int>(panels.size());
  cv::Mat drawing(size + kPanelCaption, count * size + (count - 1) * kPanelSeparator, CV_8UC1,
                  cv::Scalar(0));
  for (int i = 0; i < count; ++i) {
    const int left = i * (size + kPanelSeparator);
    if (i > 0) drawing.colRange(left - kPanelSeparator, left).setTo(separator_grey);
    drawText(panels[i].caption, {left + 6, size + kPanelCaption - 7}, caption_grey, &drawing);
    if (panels[i].image.empty()) continue;
    Image pixels = panels[i].image;  // cv::Mat requires mutable pixels
    const cv::Mat image(image_size, image_size, CV_8UC1, pixels.data());
    cv::resize(image, drawing(cv::Rect(left, 0, size, size)), cv::Size(size, size), 0.0, 0.0,
               cv::INTER_NEAREST);
  }
  return drawing;
}

}  // namespace ddm
