// The camera model: random streams, disturbances and the delay of images.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/camera.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ddm_sim/plant.h"

namespace ddm {
namespace {

constexpr double kTwoPi = 2 * kPi;
constexpr int kNumShapes = 30;
constexpr double kBrightnessPeriod = 20.0;  // the length of a trial of the pendulum [s]

/// A disc or a rotated rectangle; lengths in pixels.
struct Shape {
  bool disc;
  double x, y;  ///< position of the centre
  double half_width, half_height;
  double cos, sin;  ///< of the angle of rotation
  double softness;  ///< width over which the edge fades
  double grey;

  /// Share of the pixel around (px, py) that the shape covers, in [0, 1].
  double cover(double px, double py) const {
    const double along = (px - x) * cos + (py - y) * sin;
    const double across = (py - y) * cos - (px - x) * sin;
    const double outside =
        disc ? std::hypot(along, across) - half_width
             : std::max(std::abs(along) - half_width, std::abs(across) - half_height);
    return std::clamp(0.5 - outside / softness, 0.0, 1.0);
  }
};

Shape drawShape(int width, int height, std::mt19937_64* rng) {
  const auto uniform = [rng](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(*rng);
  };
  const int size = std::min(width, height);
  Shape shape;
  shape.disc = uniform(0.0, 1.0) < 0.5;
  shape.x = uniform(0.0, width);
  shape.y = uniform(0.0, height);
  shape.half_width = uniform(0.03, 0.2) * size;
  shape.half_height = uniform(0.03, 0.2) * size;
  const double angle = uniform(0.0, kTwoPi);
  shape.cos = std::cos(angle);
  shape.sin = std::sin(angle);
  const bool hard = uniform(0.0, 1.0) < 0.5;
  const double soft = uniform(0.05, 0.2) * size;
  shape.softness = hard ? 1.0 : soft;
  shape.grey = uniform(0.0, 1.0);
  return shape;
}

/// Draws shapes on black, each in front of the previous ones, and scales the brightest pixel to
/// `highest`.                                                                      [width * height]
std::vector<double> drawClutter(int width, int height, double highest) {
  std::vector<double> grey(static_cast<std::size_t>(width) * height, 0.0);
  std::mt19937_64 rng = randomStream(TrialId(), StreamRole::kClutter);
  for (int k = 0; k < kNumShapes; ++k) {
    const Shape shape = drawShape(width, height, &rng);
    auto pixel = grey.begin();
    for (int i = 0; i < height; ++i) {
      for (int j = 0; j < width; ++j, ++pixel) {
        *pixel += shape.cover(j + 0.5, i + 0.5) * (shape.grey - *pixel);
      }
    }
  }
  const double brightest = *std::max_element(grey.begin(), grey.end());
  for (double& pixel : grey) pixel *= highest / brightest;
  return grey;
}

}  // namespace

std::vector<std::string> CameraOptions::problems() const {
  OptionChecks camera("camera");
  camera.requireWithin("noise_std", noise_std, 0.0, 1.0);
  camera.requireFraction("brightness_drift", brightness_drift);
  camera.requireWithin("clutter", clutter, 0.0, 1.0);
  camera.requireWithin("delay", delay, 0, 1000);
  // Readers of bags use the median interval of the stamps as the time step, so most images must
  // have a direct successor.
  camera.requireWithin("drop_rate", drop_rate, 0.0, 0.3);
  return camera.problems();
}

Camera::Camera(const CameraOptions& options, double dt) : options_(checked(options)), dt_(dt) {
  begin(TrialId());
}

void Camera::begin(const TrialId& id) {
  rng_ = randomStream(id, StreamRole::kCamera);
  noise_ = randomStream(id, StreamRole::kNoise);
  phase_ = std::uniform_real_distribution<double>(0.0, kTwoPi)(rng_);
  taken_.clear();
  frame_ = 0;
}

std::optional<RenderedImage> Camera::capture(const RenderedImage& rendered) {
  const int frame = frame_++;
  const double draw = std::uniform_real_distribution<double>(0.0, 1.0)(rng_);
  if (frame > 0 && draw < options_.drop_rate) {
    taken_.push_back(std::nullopt);
  } else {
    const double turns = frame * dt_ / kBrightnessPeriod;
    const double brightness = 1.0 + options_.brightness_drift * std::sin(kTwoPi * turns + phase_);
    taken_.push_back(expose(rendered, brightness, &noise_));
  }
  if (static_cast<int>(taken_.size()) > options_.delay + 1) taken_.pop_front();
  return taken_.front();
}

RenderedImage Camera::captureGoal(const RenderedImage& rendered) {
  std::mt19937_64 noise = randomStream(TrialId(), StreamRole::kGoalNoise);
  return expose(rendered, /*brightness=*/1.0, &noise);
}

RenderedImage Camera::expose(const RenderedImage& rendered, double brightness,
                             std::mt19937_64* noise) {
  RenderedImage out = rendered;
  out.cover.clear();
  const bool cluttered = options_.clutter > 0.0;
  if (brightness == 1.0 && !cluttered && options_.noise_std == 0.0) return out;
  if (cluttered && rendered.cover.empty()) {
    throw std::invalid_argument(
        "camera/clutter must be 0 where the plant's rendered image does not say what it covers, as "
        "that of a model file: add a background to the model file instead");
  }
  if (cluttered && clutter_.size() != rendered.numPixels()) {
    clutter_ = drawClutter(rendered.width, rendered.height, options_.clutter);
  }
  std::normal_distribution<double> standard_normal;
  for (std::size_t i = 0; i < out.bytes.size(); ++i) {
    const std::size_t pixel = i / static_cast<std::size_t>(rendered.channels);
    double value = rendered.bytes[i] / 255.0;
    if (cluttered) value += (1.0 - rendered.cover[pixel] / 255.0) * clutter_[pixel];
    value *= brightness;
    if (options_.noise_std > 0.0) value += options_.noise_std * standard_normal(*noise);
    out.bytes[i] = static_cast<std::uint8_t>(255.0 * std::clamp(value, 0.0, 1.0) + 0.5);
  }
  return out;
}

}  // namespace ddm
