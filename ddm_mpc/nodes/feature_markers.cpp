// The feature space for rviz, in three dimensions: what feature_plane.h draws, as markers.
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_markers.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace ddm {
namespace {

using visualization_msgs::Marker;

constexpr int kPointsPerImage = 12;     // along each side
constexpr double kSmallSphere = 0.025;  // diameters, in features
constexpr double kPlanSphere = 0.04;
constexpr double kLargeSphere = 0.12;
constexpr double kLine = 0.015;
constexpr double kLetter = 0.14;
constexpr double kBehind = 0.01;    // images are drawn below their plane, so that dots stay visible
constexpr double kFarthest = 10.0;  // as in the picture
const cv::Scalar kAxes(160, 160, 160);

std_msgs::ColorRGBA colourOf(const cv::Scalar& rgb) {
  std_msgs::ColorRGBA colour;
  colour.r = static_cast<float>(rgb[0] / 255.0);
  colour.g = static_cast<float>(rgb[1] / 255.0);
  colour.b = static_cast<float>(rgb[2] / 255.0);
  colour.a = 1.0F;
  return colour;
}

geometry_msgs::Point pointOf(const Eigen::Ref<const Eigen::VectorXd>& z) {
  const auto feature = [&z](Eigen::Index i) {
    return i < z.size() ? std::min(kFarthest, std::max(-kFarthest, z[i])) : 0.0;
  };
  geometry_msgs::Point point;
  point.x = feature(0);
  point.y = feature(1);
  point.z = feature(2);
  return point;
}

Marker marker(const char* name_space, int type, const cv::Scalar& rgb, double size,
              const ros::Time& stamp) {
  Marker out;
  out.header.frame_id = kFeatureSpaceFrame;
  out.header.stamp = stamp;
  out.ns = name_space;
  out.type = type;
  out.color = colourOf(rgb);
  out.scale.x = out.scale.y = out.scale.z = size;
  out.pose.orientation.w = 1.0;
  return out;
}

/// Fills in the points; a marker without any is deleted.
Marker withPoints(Marker out, const Eigen::MatrixXd& features) {
  for (Eigen::Index i = 0; i < features.cols(); ++i) out.points.push_back(pointOf(features.col(i)));
  if (out.points.empty()) out.action = Marker::DELETE;
  return out;
}

Marker imagesOf(const FeaturePlane& plane, const ros::Time& stamp) {
  constexpr int kPixelsPerPoint = FeaturePlane::kPitch / kPointsPerImage;
  constexpr double kStep = kPixelsPerPoint / FeaturePlane::kUnit;
  constexpr double kOverlap = 1.25;  // seen from the side, points must not leave gaps
  Marker out = marker("images", Marker::POINTS, cv::Scalar(), kOverlap * kStep, stamp);
  cv::Mat pixels;
  cv::resize(plane.images(), pixels, plane.images().size() / kPixelsPerPoint, 0.0, 0.0,
             cv::INTER_AREA);
  for (int row = 0; row < pixels.rows; ++row) {
    for (int column = 0; column < pixels.cols; ++column) {
      geometry_msgs::Point point = pointOf(plane.slice());
      point.x = kStep * (column - 0.5 * (pixels.cols - 1));
      point.y = kStep * (0.5 * (pixels.rows - 1) - row);
      point.z -= kBehind;
      out.points.push_back(point);
      out.colors.push_back(colourOf(pixels.at<cv::Vec3b>(row, column)));
    }
  }
  return out;
}

}  // namespace

visualization_msgs::MarkerArray overlayMarkers(const FeatureOverlay& overlay,
                                               const ros::Time& stamp) {
  namespace colours = feature_colours;
  visualization_msgs::MarkerArray out;
  out.markers = {
      withPoints(
          marker("experience", Marker::SPHERE_LIST, colours::kExperience, kSmallSphere, stamp),
          overlay.experience),
      withPoints(marker("plan", Marker::LINE_STRIP, colours::kPlan, kLine, stamp), overlay.plan),
      withPoints(marker("plan", Marker::SPHERE_LIST, colours::kPlan, kPlanSphere, stamp),
                 overlay.plan),
      withPoints(marker("goal", Marker::SPHERE_LIST, colours::kGoal, kLargeSphere, stamp),
                 overlay.goal),
      withPoints(marker("current", Marker::SPHERE_LIST, colours::kCurrent, kLargeSphere, stamp),
                 overlay.current)};
  out.markers[2].id = 1;  // the dots of the plan, beside its line
  return out;
}

visualization_msgs::MarkerArray gridMarkers(const FeaturePlane& plane, const ros::Time& stamp) {
  visualization_msgs::MarkerArray out;
  out.markers.push_back(imagesOf(plane, stamp));
  Marker range = marker("axes", Marker::LINE_LIST, kAxes, kLine, stamp);
  const int dim = static_cast<int>(std::min<Eigen::Index>(3, plane.slice().size()));
  for (int axis = 0; axis < dim; ++axis) {
    // The edges of the square or cube along this axis: one for each combination of the other signs.
    for (int corner = 0; corner < (1 << dim); ++corner) {
      if ((corner >> axis & 1) != 0) continue;
      Eigen::VectorXd z(dim);
      for (int i = 0; i < dim; ++i) z[i] = (corner >> i & 1) != 0 ? M_PI_2 : -M_PI_2;
      range.points.push_back(pointOf(z));
      z[axis] = M_PI_2;
      range.points.push_back(pointOf(z));
    }
    Marker name = marker("axes", Marker::TEXT_VIEW_FACING, kAxes, kLetter, stamp);
    name.id = axis + 1;
    name.text = "z" + std::to_string(axis + 1);
    name.pose.position = pointOf((M_PI_2 + kLetter) * Eigen::VectorXd::Unit(dim, axis));
    out.markers.push_back(name);
  }
  out.markers.push_back(range);
  return out;
}

}  // namespace ddm
