// The learning curve as a picture: what the model after each trial could do.
// SPDX-License-Identifier: BSD-3-Clause
#include "learning_curve_image.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

namespace ddm {
namespace {

const cv::Size kSize(640, 480);
const cv::Rect kUpper(58, 34, 550, 218);
const cv::Rect kLower(58, 292, 550, 138);
// From the Okabe-Ito set: told apart by colour-blind readers, and the shapes differ too.
const cv::Scalar kBlue(0, 114, 178);
const cv::Scalar kRed(213, 94, 0);
const cv::Scalar kOrange(230, 159, 0);
const cv::Scalar kGrey(102, 102, 102);
const cv::Scalar kLight(221, 221, 221);
const cv::Scalar kBlack(0, 0, 0);
constexpr int kMostTicks = 8;

void write(const std::string& text, const cv::Point& at, const cv::Scalar& colour,
           cv::Mat* picture) {
  cv::putText(*picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv::LINE_AA);
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[64];
  std::snprintf(text, sizeof(text), pattern, values...);
  return text;
}

/// A coordinate system with frames to the right.
struct Axes {
  cv::Rect area;
  double max_x;
  double min_y, max_y;

  cv::Point at(double x, double y) const {
    const double share = std::min(1.0, std::max(0.0, (y - min_y) / (max_y - min_y)));
    return {area.x + static_cast<int>(std::lround(area.width * x / max_x)),
            area.br().y - static_cast<int>(std::lround(area.height * share))};
  }
};

/// 1, 2 or 5 times a power of ten, so that at most kMostTicks fit.
double tickStep(double max) {
  double step = 1.0;
  for (int i = 0; max / step > kMostTicks; ++i) step *= i % 3 == 1 ? 2.5 : 2.0;
  return step;
}

void drawFrame(const Axes& axes, const std::vector<double>& ticks, const char* tick_format,
               cv::Mat* picture) {
  for (const double y : ticks) {
    const cv::Point left = axes.at(0.0, y);
    cv::line(*picture, left, axes.at(axes.max_x, y), kLight);
    write(format(tick_format, y), {left.x - 50, left.y + 5}, kBlack, picture);
  }
  const double step = tickStep(axes.max_x);
  for (double x = 0.0; x <= axes.max_x; x += step) {
    const cv::Point bottom = axes.at(x, axes.min_y);
    cv::line(*picture, bottom, axes.at(x, axes.max_y), kLight);
    write(format("%.0f", x), {bottom.x - 12, bottom.y + 16}, kBlack, picture);
  }
  cv::rectangle(*picture, axes.area, kGrey);
}

void drawCurve(const Axes& axes, const std::vector<cv::Point2d>& points, const cv::Scalar& colour,
               cv::Mat* picture) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    cv::line(*picture, axes.at(points[i - 1].x, points[i - 1].y), axes.at(points[i].x, points[i].y),
             colour, 1, cv::LINE_AA);
  }
}

std::string titleOf(const std::vector<TrialRow>& rows, const std::string& unit) {
  const std::string title = "distance from the goal at the end [" + unit + "]";
  if (rows.empty()) return title;
  const TrialRow& last = rows.back();
  if (!last.evaluation.known) return title + ": not known, no ground truth";
  const std::string end = format(", after trial %d: ", last.trial) +
                          (last.evaluation.success ? "success" : "no success");
  if (!last.evaluation.final_error) return "judged by the distance in features" + end;
  return title + end + format(", %.3g", *last.evaluation.final_error);
}

void drawErrors(const std::vector<TrialRow>& rows, double max_x,
                const EvaluationOptions& evaluation, cv::Mat* picture) {
  const bool known = rows.empty() || rows.back().evaluation.final_error.has_value();
  double largest = 2.0 * evaluation.tolerance;
  for (const TrialRow& row : rows) {
    largest = std::max(largest, row.evaluation.final_error.value_or(0.0));
  }
  const Axes axes{kUpper, max_x, 0.0, known ? largest : 1.0};
  std::vector<double> ticks;
  for (int i = 0; known && i <= 4; ++i) ticks.push_back(largest * i / 4);
  drawFrame(axes, ticks, "%5.3g", picture);
  if (known) {
    const double tolerance = evaluation.tolerance;
    cv::line(*picture, axes.at(0.0, tolerance), axes.at(max_x, tolerance), kGrey);
  }
  std::vector<cv::Point2d> points;
  for (const TrialRow& row : rows) {
    if (row.evaluation.final_error) points.emplace_back(row.frames, *row.evaluation.final_error);
  }
  drawCurve(axes, points, kGrey, picture);
  for (const TrialRow& row : rows) {
    if (!row.evaluation.known) continue;
    const double mark = row.evaluation.success ? 0.25 : 0.75;  // two rows, without an error
    const cv::Point at = axes.at(row.frames, row.evaluation.final_error.value_or(mark));
    if (row.evaluation.success) {
      cv::circle(*picture, at, 6, kBlue, cv::FILLED, cv::LINE_AA);
    } else {
      cv::drawMarker(*picture, at, kRed, cv::MARKER_TILTED_CROSS, 12, 3, cv::LINE_AA);
    }
  }
  write(titleOf(rows, evaluation.error_unit), {kUpper.x, kUpper.y - 12}, kBlack, picture);
}

using Value = std::optional<double> TrialRow::*;

/// log10 of an error per frame; rows without one are left out.
std::vector<cv::Point2d> logarithms(const std::vector<TrialRow>& rows, Value value) {
  std::vector<cv::Point2d> points;
  for (const TrialRow& row : rows) {
    if (!(row.*value) || !(*(row.*value) > 0.0) || row.frames == 0) continue;
    points.emplace_back(row.frames, std::log10(*(row.*value) / row.frames));
  }
  return points;
}

void drawModelErrors(const std::vector<TrialRow>& rows, double max_x, cv::Mat* picture) {
  const auto v_r = logarithms(rows, &TrialRow::v_r), v_p = logarithms(rows, &TrialRow::v_p);
  double low = 0.0, high = 1.0;  // decades
  if (!v_r.empty() || !v_p.empty()) {
    low = std::numeric_limits<double>::infinity();
    high = -low;
    for (const auto* points : {&v_r, &v_p}) {
      for (const cv::Point2d& point : *points) {
        low = std::min(low, std::floor(point.y));
        high = std::max(high, std::floor(point.y) + 1.0);
      }
    }
  }
  const Axes axes{kLower, max_x, low, high};
  std::vector<double> decades;
  for (double decade = low; decade <= high; ++decade) decades.push_back(decade);
  drawFrame(axes, decades, "1e%+.0f", picture);
  drawCurve(axes, v_r, kGrey, picture);
  drawCurve(axes, v_p, kOrange, picture);
  for (const cv::Point2d& point : v_r)
    cv::circle(*picture, axes.at(point.x, point.y), 3, kGrey, -1);
  for (const cv::Point2d& point : v_p)
    cv::circle(*picture, axes.at(point.x, point.y), 3, kOrange, -1);
  const cv::Point title(kLower.x, kLower.y - 10);
  write("per frame [grey^2]:", title, kBlack, picture);
  write("reconstruction V_R", title + cv::Point(160, 0), kGrey, picture);
  write("prediction V_P", title + cv::Point(320, 0), kOrange, picture);
  write("frames learned from", {kLower.x + 200, kSize.height - 10}, kBlack, picture);
}

}  // namespace

cv::Mat drawLearningCurve(const std::vector<TrialRow>& rows, std::uint32_t all_frames,
                          const EvaluationOptions& evaluation) {
  cv::Mat picture(kSize, CV_8UC3, cv::Scalar(255, 255, 255));
  double max_x = std::max(1U, all_frames);
  for (const TrialRow& row : rows) max_x = std::max(max_x, static_cast<double>(row.frames));
  drawErrors(rows, max_x, evaluation, &picture);
  drawModelErrors(rows, max_x, &picture);
  return picture;
}

}  // namespace ddm
