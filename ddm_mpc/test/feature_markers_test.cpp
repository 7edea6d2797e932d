// Tests of the markers of the feature space: where they are, in which colour, and what is deleted.
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_markers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "random_model.h"

namespace ddm {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

const ros::Time kStamp(3.0);

Ddm modelOfDim(int feature_dim) {
  RandomModelOptions options;
  options.model.feature_dim = feature_dim;
  return randomModel(options);
}

FeatureOverlay fullOverlay(int feature_dim) {
  FeatureOverlay overlay;
  overlay.experience = testing::randomMatrix(feature_dim, 7, 1);
  overlay.plan = testing::randomMatrix(feature_dim, 4, 2);
  overlay.goal = testing::randomMatrix(feature_dim, 1, 3);
  overlay.current = testing::randomMatrix(feature_dim, 1, 4);
  return overlay;
}

std::vector<Marker> named(const MarkerArray& array, const std::string& name_space) {
  std::vector<Marker> found;
  for (const Marker& marker : array.markers) {
    if (marker.ns == name_space) found.push_back(marker);
  }
  return found;
}

void expectColour(const std_msgs::ColorRGBA& colour, const cv::Scalar& rgb) {
  EXPECT_NEAR(colour.r, rgb[0] / 255.0, 1e-6);
  EXPECT_NEAR(colour.g, rgb[1] / 255.0, 1e-6);
  EXPECT_NEAR(colour.b, rgb[2] / 255.0, 1e-6);
  EXPECT_EQ(colour.a, 1.0F);
}

void expectPoints(const Marker& marker, const Eigen::MatrixXd& features) {
  ASSERT_EQ(marker.points.size(), static_cast<std::size_t>(features.cols()));
  for (Eigen::Index i = 0; i < features.cols(); ++i) {
    EXPECT_EQ(marker.points[i].x, features(0, i));
    EXPECT_EQ(marker.points[i].y, features.rows() > 1 ? features(1, i) : 0.0);
    EXPECT_EQ(marker.points[i].z, features.rows() > 2 ? features(2, i) : 0.0);
  }
}

/// What rviz needs of every marker.
void expectShowable(const MarkerArray& array) {
  std::set<std::pair<std::string, int>> names;
  for (const Marker& marker : array.markers) {
    EXPECT_EQ(marker.header.frame_id, "feature_space");
    EXPECT_EQ(marker.header.stamp, kStamp);
    EXPECT_EQ(marker.pose.orientation.w, 1.0);
    EXPECT_GT(marker.scale.x, 0.0);
    EXPECT_TRUE(names.emplace(marker.ns, marker.id).second) << marker.ns << " " << marker.id;
  }
}

TEST(FeatureMarkers, ShowEachPartOfTheOverlayInItsColourWhateverTheNumberOfFeatures) {
  for (const int dim : {1, 2, 3, 5}) {
    const FeatureOverlay overlay = fullOverlay(dim);
    const MarkerArray array = overlayMarkers(overlay, kStamp);
    expectShowable(array);
    expectPoints(named(array, "experience").at(0), overlay.experience);
    expectPoints(named(array, "goal").at(0), overlay.goal);
    expectPoints(named(array, "current").at(0), overlay.current);
    expectColour(named(array, "experience").at(0).color, feature_colours::kExperience);
    expectColour(named(array, "goal").at(0).color, feature_colours::kGoal);
    expectColour(named(array, "current").at(0).color, feature_colours::kCurrent);
    ASSERT_EQ(named(array, "plan").size(), 2U);
    for (const Marker& marker : named(array, "plan")) {
      expectPoints(marker, overlay.plan);
      expectColour(marker.color, feature_colours::kPlan);
    }
    EXPECT_EQ(named(array, "plan").at(0).type, Marker::LINE_STRIP);
  }
}

TEST(FeatureMarkers, DeleteWhatIsNotThereAnyMore) {
  FeatureOverlay overlay = fullOverlay(2);
  overlay.plan.resize(2, 0);
  for (const Marker& marker : overlayMarkers(overlay, kStamp).markers) {
    EXPECT_EQ(marker.action, marker.ns == "plan" ? Marker::DELETE : Marker::ADD) << marker.ns;
  }
}

TEST(FeatureMarkers, BringFarFeaturesAndThoseThatAreNoNumbersNear) {
  FeatureOverlay overlay;
  overlay.current.resize(2, 1);
  overlay.current << 1e300, std::numeric_limits<double>::quiet_NaN();
  const Marker marker = named(overlayMarkers(overlay, kStamp), "current").at(0);
  EXPECT_EQ(marker.points.at(0).x, 10.0);
  EXPECT_TRUE(std::isfinite(marker.points.at(0).y));
}

TEST(FeatureMarkers, ShowTheDecodedImagesWhereTheirFeaturesAre) {
  for (const int dim : {1, 2, 3}) {
    const Ddm model = modelOfDim(dim);
    const MarkerArray array = gridMarkers(FeaturePlane(model), kStamp);
    expectShowable(array);
    const Marker images = named(array, "images").at(0);
    ASSERT_EQ(images.points.size(), 9U * 144U * (dim == 1 ? 1U : 9U));
    ASSERT_EQ(images.colors.size(), images.points.size());
    Eigen::VectorXd z = model.hasGoal() ? model.goalFeature() : Eigen::VectorXd::Zero(dim);
    z[0] = 0.75;
    if (dim > 1) z[1] = -0.5;
    double expected = 0.0, shown = 0.0;
    int count = 0;
    for (const std::uint8_t k : model.decode(z)) expected += k / 255.0 / 64.0;
    for (std::size_t i = 0; i < images.points.size(); ++i) {
      const geometry_msgs::Point& point = images.points[i];
      EXPECT_NEAR(point.z, dim > 2 ? z[2] : 0.0, 0.02);
      if (std::abs(point.x - z[0]) > 0.125) continue;
      if (dim > 1 && std::abs(point.y - z[1]) > 0.125) continue;
      ++count;
      shown += images.colors[i].g / 144.0;
    }
    EXPECT_EQ(count, 144);
    EXPECT_NEAR(shown, expected, 0.01);
  }
}

TEST(FeatureMarkers, FrameTheRangeOfAllFeaturesThatCanBeSeen) {
  for (const auto& [dim, edges] : {std::make_pair(1, 1U), std::make_pair(2, 4U),
                                   std::make_pair(3, 12U), std::make_pair(5, 12U)}) {
    const MarkerArray array = gridMarkers(FeaturePlane(modelOfDim(dim)), kStamp);
    std::size_t names = 0;
    for (const Marker& marker : named(array, "axes")) {
      if (marker.type == Marker::TEXT_VIEW_FACING) {
        ++names;
        continue;
      }
      EXPECT_EQ(marker.points.size(), 2 * edges);
      for (std::size_t i = 0; i + 1 < marker.points.size(); i += 2) {
        const geometry_msgs::Point &a = marker.points[i], &b = marker.points[i + 1];
        EXPECT_NEAR(std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z), M_PI, 1e-9);
      }
    }
    EXPECT_EQ(names, std::min(3U, static_cast<unsigned>(dim)));
  }
}

}  // namespace
}  // namespace ddm
