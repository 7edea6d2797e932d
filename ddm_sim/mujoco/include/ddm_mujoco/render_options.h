// How a scene is drawn: through which camera, how large, how smooth.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace ddm {

/// The camera is one of the model (`camera`), or stands where the model has none (`position`).
struct RenderOptions {
  std::string camera;            ///< name in the model; empty: its first one
  std::vector<double> position;  ///< of a camera that the model does not have [m]    [0 or 3]
  std::vector<double> look_at;   ///< the point in the middle of its picture [m]      [0 or 3]
  double field_of_view = 45.0;   ///< vertical angle of a camera at `position` [deg]
  int width = 51;                ///< [pixels]
  int height = 51;               ///< [pixels]
  bool colour = false;           ///< else grey
  int samples = 0;               ///< 0, or 4: edges are averaged over four points of a pixel
  int supersampling = 1;         ///< drawn so many times larger and averaged, which is softer
  bool for_people = false;       ///< also show the geoms and sites of group kPeopleGroup

  static constexpr int kPeopleGroup = 4;
  static constexpr int kMaxSize = 4096;  ///< of what is drawn: 1 GB of memory with samples [pixels]

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  /// @param block  that they stand in, for messages: "plant"
  std::vector<std::string> problems(const std::string& block) const {
    OptionChecks checks(block);
    const auto requirePoint = [&checks](const std::string& key, const std::vector<double>& point) {
      const bool finite =
          std::all_of(point.begin(), point.end(), [](double x) { return std::isfinite(x); });
      checks.require(point.empty() || (point.size() == 3 && finite), key,
                     "be a point of three finite numbers",
                     std::to_string(point.size()) + " of them");
    };
    requirePoint("camera_position", position);
    requirePoint("camera_look_at", look_at);
    checks.require(position.empty() == look_at.empty(), "camera_look_at",
                   "be given where camera_position is",
                   position.empty() ? "no position" : "no point to look at");
    checks.require(position.empty() || position != look_at, "camera_look_at",
                   "differ from camera_position", "the same");
    checks.require(camera.empty() || position.empty(), "camera",
                   "be left out where camera_position is given", camera);
    checks.require(field_of_view > 0.0 && field_of_view < 180.0, "camera_field_of_view",
                   "lie in (0, 180) deg", field_of_view);
    checks.require(samples == 0 || samples == 4, "samples", "be 0 or 4", samples);
    checks.require(supersampling >= 1 && supersampling <= 8, "supersampling", "lie in [1, 8]",
                   supersampling);
    for (const int size : {width, height}) {
      checks.require(size >= 1 && size * supersampling <= kMaxSize, "supersampling",
                     "times the size of the picture lie in [1, 4096] pixels", size * supersampling);
    }
    return checks.problems();
  }
};

/// Nuisances that stand in the scene. All 0: the scene of the model. Each number is the share of
/// the largest change that there is; 0.1 is easy.
struct SceneOptions {
  double camera_shift = 0.0;  ///< the camera goes around the point it looks at, and turns
  double colour_shift = 0.0;  ///< of each thing, texture and sky
  int seed = 0;               ///< which changes

  /// As above.
  std::vector<std::string> problems(const std::string& block) const {
    OptionChecks checks(block);
    const auto requireShare = [&checks](const std::string& key, double share) {
      checks.require(share >= 0.0 && share <= 1.0, key, "lie in [0, 1]", share);
    };
    requireShare("camera_shift", camera_shift);
    requireShare("colour_shift", colour_shift);
    checks.require(seed >= 0, "scene_seed", "be >= 0", seed);
    return checks.problems();
  }
};

}  // namespace ddm
