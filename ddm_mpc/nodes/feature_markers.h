// The feature space for rviz, in three dimensions: what feature_plane.h draws, as markers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include "feature_plane.h"

namespace ddm {

/// Frame of the markers: x, y and z are the first three features. It is no place in the world, so
/// there is no transform: rviz shows it as its fixed frame.
constexpr char kFeatureSpaceFrame[] = "feature_space";

/// Experience, plan, goal and current feature, each in a namespace of its own. What the overlay
/// does not have is deleted.
visualization_msgs::MarkerArray overlayMarkers(const FeatureOverlay& overlay,
                                               const ros::Time& stamp);

/// What changes with the model alone: the decoded images in their plane (12 x 12 points each), and
/// the range of arctan features, +-pi/2, with the names of the axes.
visualization_msgs::MarkerArray gridMarkers(const FeaturePlane& plane, const ros::Time& stamp);

}  // namespace ddm
