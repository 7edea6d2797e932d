// The camera: photographs of a plant as a learner gets them, with what may go wrong with them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// The only thing that looks at a plant for a learner. A photograph of the state s at frame t is
///
///   y = clamp(b_t (p + (1 - a) c) + noise_std n, 0, 1),
///   b_t = 1 + brightness_drift sin(2 pi t dt / brightness_period + phase),   n ~ N(0, 1)
///
/// pixel by pixel, with p = Plant::render(s) in front of the clutter c, which a =
/// Plant::coverage(s) hides and which is the same in all runs; the phase is uniform, another one in
/// each run. With the probability drop_rate the photograph is lost; else it comes `delay` frames
/// late, as it was taken. With all nuisances at 0 it is Plant::render(), byte by byte.
///
/// Noise has a random stream of its own, so that it changes neither brightness nor which frames are
/// lost. Draws are fixed for libstdc++, see Plant::drawStart().
/// Deviation: the paper's camera is perfect.
class Camera {
 public:
  /// Ready for the run (0, 0, false).
  /// @throws std::invalid_argument with all problems of the options
  explicit Camera(const CameraOptions& options);

  /// The next photograph is the first of a run.
  /// @param seed        seed of the experiment
  /// @param trial       number of the trial, 0 is the random one
  /// @param evaluation  the greedy run after `trial`
  void begin(std::uint64_t seed, std::uint32_t trial, bool evaluation);

  /// Takes the photograph of this time step, to be called once in each, and shows the one of
  /// `delay` calls ago, at the start of a run that of the first call.
  /// @return bytes as from Plant::render(), or nothing if that one is lost; the first never is
  /// @throws std::invalid_argument if the plant's picture is not of camera/size, or if it does not
  ///         say what it covers and camera/clutter is not 0
  std::optional<std::vector<std::uint8_t>> photograph(const Plant& plant);

  /// The goal image: the goal state before the same background, in nominal brightness. Its noise is
  /// the same whenever it is taken, in all runs of all seeds.
  /// @throws std::invalid_argument as photograph()
  std::vector<std::uint8_t> photographGoal(const Plant& plant) const;

 private:
  using Picture = std::vector<std::uint8_t>;

  std::optional<Picture> take(const Plant& plant);
  Picture expose(const Plant& plant, const Eigen::VectorXd& state, double brightness,
                 std::mt19937_64* noise) const;

  CameraOptions options_;
  std::vector<double> background_;  ///< c, grey in [0, 1]                   [size * size]
  std::mt19937_64 rng_;             ///< brightness and lost frames
  std::mt19937_64 noise_;
  double phase_ = 0.0;                        ///< of the brightness [rad]
  std::deque<std::optional<Picture>> taken_;  ///< the one on show, then those not shown yet
  int frame_ = 0;                             ///< t of the next photograph
};

}  // namespace ddm
