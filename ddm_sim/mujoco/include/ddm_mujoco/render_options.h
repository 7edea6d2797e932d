// How a scene is drawn: through which camera, how large, how smooth.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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
  bool shadows = true;           ///< of lights that cast them
  bool reflections = true;       ///< on materials that have them
  int samples = 0;               ///< 0, or 4: edges are averaged over four points of a pixel
  int supersampling = 1;         ///< drawn so many times larger and averaged, which is softer
  bool for_people = false;       ///< also show the geoms and sites of group kPeopleGroup

  static constexpr int kPeopleGroup = 4;

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  /// @param block  that they stand in, for messages: "plant"
  std::vector<std::string> problems(const std::string& block) const;
};

/// Nuisances that stand in the scene. All 0: the scene of the model. Each number is the share of
/// the largest change that there is; 0.1 is easy.
struct SceneOptions {
  double camera_shift = 0.0;  ///< the camera goes around the point it looks at, and turns
  double colour_shift = 0.0;  ///< of each thing, texture and sky
  double light_shift = 0.0;   ///< place and strength of each light
  double background = 0.0;    ///< of what sky, floor and walls show: a pattern, or a picture
  std::vector<std::string> background_pictures;  ///< files, one of which it is; none: a pattern
  int seed = 0;                                  ///< which changes

  /// As above.
  std::vector<std::string> problems(const std::string& block) const;
};

}  // namespace ddm
