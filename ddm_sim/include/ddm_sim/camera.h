// The camera: pictures of a plant as a learner gets them, with what may go wrong with them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "ddm_sim/picture.h"

namespace ddm {

/// Faults of the camera, see Camera; if all are 0, the camera is perfect. YAML block `camera:`.
struct CameraOptions {
  double noise_std = 0.0;         ///< standard deviation of each pixel in each frame [grey]
  double brightness_drift = 0.0;  ///< amplitude of a slow change of brightness [-]
  double clutter = 0.0;           ///< largest grey value of a static background [grey]
  int delay = 0;                  ///< so many frames late [-]
  double drop_rate = 0.0;         ///< probability that a frame is lost [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("noise_std", noise_std);
    visitor("brightness_drift", brightness_drift);
    visitor("clutter", clutter);
    visitor("delay", delay);
    visitor("drop_rate", drop_rate);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// Turns what there is to see into photographs. That of the picture p at frame t is
///
///   y = clamp(b_t (p + (1 - a) c) + noise_std n, 0, 1),
///   b_t = 1 + brightness_drift sin(2 pi t dt / 20 s + phase),   n ~ N(0, 1)
///
/// value by value, with p in front of the grey clutter c, which p's cover a hides and which is the
/// same in all runs; the phase is uniform, another one in each run. With the probability drop_rate
/// the photograph is lost; else it comes `delay` frames late, as it was taken. With all faults at 0
/// it is p, byte by byte.
///
/// Noise has a random stream of its own, so that it changes neither brightness nor which frames are
/// lost. Draws are fixed for libstdc++, see Plant::drawStart().
/// Deviation: the paper's camera is perfect.
class Camera {
 public:
  /// Ready for the run (0, 0, false).
  /// @param dt  time between two frames [s]
  /// @throws std::invalid_argument with all problems of the options
  Camera(const CameraOptions& options, double dt);

  /// The next photograph is the first of a run.
  /// @param seed        seed of the experiment
  /// @param trial       number of the trial, 0 is the random one
  /// @param evaluation  the greedy run after `trial`
  void begin(std::uint64_t seed, std::uint32_t trial, bool evaluation);

  /// Takes the photograph of this time step, to be called once in each, and shows the one of
  /// `delay` calls ago, at the start of a run that of the first call.
  /// @return nothing if that one is lost; the first never is
  /// @throws std::invalid_argument if there is clutter and `picture` does not know its cover
  std::optional<Picture> photograph(const Picture& picture);

  /// A photograph in nominal brightness whose noise is the same whenever it is taken, in all runs
  /// of all seeds: for the goal image.
  /// @throws std::invalid_argument as photograph()
  Picture photographGoal(const Picture& picture);

 private:
  Picture expose(const Picture& picture, double brightness, std::mt19937_64* noise);

  CameraOptions options_;
  double dt_;
  std::vector<double> clutter_;  ///< c, grey in [0, 1]; drawn for the first picture [numPixels()]
  std::mt19937_64 rng_;          ///< brightness and lost frames
  std::mt19937_64 noise_;
  double phase_ = 0.0;                        ///< of the brightness [rad]
  std::deque<std::optional<Picture>> taken_;  ///< the one on show, then those not shown yet
  int frame_ = 0;                             ///< t of the next photograph
};

}  // namespace ddm
