// How a scene is drawn: what values are valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/render_options.h"

#include <ddm_msgs/option_checks.h>

#include <algorithm>
#include <cmath>

namespace ddm {
namespace {

constexpr int kMaxSize = 4096;  // of what is drawn: 1 GB of memory with samples [pixels]

void requirePoint(OptionChecks* checks, const std::string& key, const std::vector<double>& point) {
  const bool finite =
      std::all_of(point.begin(), point.end(), [](double x) { return std::isfinite(x); });
  checks->require(point.empty() || (point.size() == 3 && finite), key,
                  "be a point of three finite numbers", std::to_string(point.size()) + " of them");
}

}  // namespace

std::vector<std::string> RenderOptions::problems(const std::string& block) const {
  OptionChecks checks(block);
  requirePoint(&checks, "camera_position", position);
  requirePoint(&checks, "camera_look_at", look_at);
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

std::vector<std::string> SceneOptions::problems(const std::string& block) const {
  OptionChecks checks(block);
  const auto requireShare = [&checks](const std::string& key, double share) {
    checks.require(share >= 0.0 && share <= 1.0, key, "lie in [0, 1]", share);
  };
  requireShare("camera_shift", camera_shift);
  requireShare("colour_shift", colour_shift);
  requireShare("light_shift", light_shift);
  requireShare("background", background);
  checks.require(background_pictures.empty() || background != 0.0, "background",
                 "be more than 0 where background_pictures is given", background);
  checks.require(seed >= 0, "scene_seed", "be >= 0", seed);
  return checks.problems();
}

}  // namespace ddm
