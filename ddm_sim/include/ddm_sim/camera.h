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

/// The only thing that looks at a plant for a learner. A photograph of the state s of frame t is
///
///   y = clamp(b_t (p + (1 - p) c) + noise_std n, 0, 1),
///   b_t = 1 + brightness_drift sin(2 pi t dt / brightness_period + phase),   n ~ N(0, 1)
///
/// pixel by pixel, with p = Plant::render(s), the plant in front of the clutter c, which is the
/// same in all runs; the phase is uniform, another one in each run. It comes `delay` frames late,
/// and with the probability drop_rate not at all. With all nuisances at 0 it is Plant::render(),
/// byte by byte.
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

  /// The frame of this time step; to be called once in each, for lost frames too. A frame that is
  /// late shows the state of `delay` calls ago, at the start of a run that of the first call.
  /// @return bytes as from Plant::render(), or nothing if the frame is lost; the first never is
  /// @throws std::invalid_argument if the plant's picture is not of camera/size
  std::optional<std::vector<std::uint8_t>> photograph(const Plant& plant);

  /// The goal image: the goal state before the same background, in nominal brightness. Its noise is
  /// the same whenever it is taken, in all runs of all seeds.
  /// @throws std::invalid_argument as photograph()
  std::vector<std::uint8_t> photographGoal(const Plant& plant) const;

 private:
  std::vector<std::uint8_t> expose(const std::vector<std::uint8_t>& plant, double brightness,
                                   std::mt19937_64* noise) const;

  CameraOptions options_;
  std::vector<double> background_;  ///< c, grey in [0, 1]                   [size * size]
  std::mt19937_64 rng_;             ///< brightness and lost frames
  std::mt19937_64 noise_;
  double phase_ = 0.0;                  ///< of the brightness [rad]
  std::deque<Eigen::VectorXd> states_;  ///< those not shown yet, after the one on show
  int frame_ = 0;                       ///< t of the next photograph
};

}  // namespace ddm
