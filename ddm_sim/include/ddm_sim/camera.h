// The camera model: turns the rendered image of a plant into the image that a learner receives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/random_stream.h>

#include <deque>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "ddm_sim/rendered_image.h"

namespace ddm {

/// Disturbances of the camera, see Camera. With all values at 0 the camera is perfect. YAML block
/// `camera:`.
struct CameraOptions {
  double noise_std = 0.0;  ///< standard deviation of the noise of each pixel of each image [grey]
  double brightness_drift = 0.0;  ///< relative amplitude of a slow change of brightness [-]
  double clutter = 0.0;           ///< largest grey value of a static background pattern [grey]
  int delay = 0;                  ///< number of time steps by which images are delayed [-]
  double drop_rate = 0.0;         ///< probability that an image is lost [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("noise_std", noise_std);
    visitor("brightness_drift", brightness_drift);
    visitor("clutter", clutter);
    visitor("delay", delay);
    visitor("drop_rate", drop_rate);
  }

  std::vector<std::string> problems() const;
};

/// Turns rendered images into the images y that a learner receives. The rendered image p of time
/// step t becomes
///
///   y = clamp(b_t (p + (1 - a) c) + noise_std n, 0, 1),
///   b_t = 1 + brightness_drift sin(2 pi t dt / 20 s + phase),   n ~ N(0, 1)
///
/// for each value of each pixel. c is a background of grey shapes, the same in all episodes of all
/// experiments. a is the share of the pixel that the plant covers (RenderedImage::cover), so the plant
/// hides the background. The phase is drawn uniformly for each episode. With probability drop_rate
/// the image is lost; all other images are delivered `delay` time steps after they were taken. With
/// all options at 0, y equals p byte for byte.
///
/// The noise has its own random stream, so a change of noise_std changes neither the brightness nor
/// the choice of lost images. The draws are reproducible for libstdc++ only, see
/// Plant::drawStart().
/// Deviation: the paper's camera has no disturbances.
class Camera {
 public:
  /// Begins the episode TrialId().
  /// @param dt  time between two images [s]
  /// @throws std::invalid_argument with all problems of the options
  Camera(const CameraOptions& options, double dt);

  /// Begins an episode: the next call of capture() takes its first image.
  void begin(const TrialId& id);

  /// Takes the image of this time step and returns the image that was taken `delay` calls earlier.
  /// The first `delay` calls of an episode return its first image. Call this function exactly once
  /// in each time step.
  /// @return the image, or nothing if it is lost; the first image of an episode is never lost
  /// @throws std::invalid_argument if clutter is > 0 and `rendered` has no cover
  std::optional<RenderedImage> capture(const RenderedImage& rendered);

  /// Takes the goal image: at nominal brightness and with a fixed draw of the noise, so that equal
  /// goals give equal images in all episodes of all experiments.
  /// @throws std::invalid_argument as capture()
  RenderedImage captureGoal(const RenderedImage& rendered);

 private:
  RenderedImage expose(const RenderedImage& rendered, double brightness, std::mt19937_64* noise);

  CameraOptions options_;
  double dt_;
  std::vector<double> clutter_;  ///< c, grey in [0, 1], drawn at the first call [numPixels()]
  std::mt19937_64 rng_;          ///< brightness and lost images
  std::mt19937_64 noise_;
  double phase_ = 0.0;  ///< phase of the brightness [rad]
  /// The image on show, then the images that wait for their delay.
  std::deque<std::optional<RenderedImage>> taken_;
  int frame_ = 0;  ///< t of the next image
};

}  // namespace ddm
