// The camera: photographs of a plant as a learner gets them, with what may go wrong with them.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/camera.h"

#include <ddm_msgs/random_stream.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

constexpr double kTwoPi = 2 * 3.14159265358979323846;
constexpr int kNumShapes = 30;

/// A disc or a turned rectangle; lengths in pixels.
struct Shape {
  bool disc;
  double x, y;  ///< of its middle
  double half_width, half_height;
  double cos, sin;  ///< of the angle that it is turned by
  double softness;  ///< width of its edge
  double grey;

  /// How much of the pixel around (px, py) it covers, in [0, 1].
  double cover(double px, double py) const {
    const double along = (px - x) * cos + (py - y) * sin;
    const double across = (py - y) * cos - (px - x) * sin;
    const double outside =
        disc ? std::hypot(along, across) - half_width
             : std::max(std::abs(along) - half_width, std::abs(across) - half_height);
    return std::clamp(0.5 - outside / softness, 0.0, 1.0);
  }
};

Shape drawShape(int size, std::mt19937_64* rng) {
  const auto uniform = [rng](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(*rng);
  };
  Shape shape;
  shape.disc = uniform(0.0, 1.0) < 0.5;
  shape.x = uniform(0.0, size);
  shape.y = uniform(0.0, size);
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

/// Shapes on black, each in front of the last, the brightest pixel `clutter`.  [size * size]
std::vector<double> drawBackground(const CameraOptions& options) {
  const int size = options.size;
  std::vector<double> grey(static_cast<std::size_t>(size) * size, 0.0);
  if (options.clutter == 0.0) return grey;
  TrialId id;
  id.seed = static_cast<std::uint64_t>(options.clutter_seed);
  std::mt19937_64 rng = randomStream(id, StreamRole::kClutter);
  for (int k = 0; k < kNumShapes; ++k) {
    const Shape shape = drawShape(size, &rng);
    auto pixel = grey.begin();
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j, ++pixel) {
        *pixel += shape.cover(j + 0.5, i + 0.5) * (shape.grey - *pixel);
      }
    }
  }
  const double brightest = *std::max_element(grey.begin(), grey.end());
  for (double& pixel : grey) pixel *= options.clutter / brightest;
  return grey;
}

/// `options` unchanged, so that the checks precede the first use of its values.
const CameraOptions& checked(const CameraOptions& options) {
  requireNone(options.problems());
  return options;
}

}  // namespace

Camera::Camera(const CameraOptions& options)
    : options_(checked(options)), background_(drawBackground(options_)) {
  begin(0, 0, false);
}

void Camera::begin(std::uint64_t seed, std::uint32_t trial, bool evaluation) {
  rng_ = randomStream({seed, trial, evaluation}, StreamRole::kCamera);
  noise_ = randomStream({seed, trial, evaluation}, StreamRole::kNoise);
  phase_ = std::uniform_real_distribution<double>(0.0, kTwoPi)(rng_);
  taken_.clear();
  frame_ = 0;
}

std::optional<std::vector<std::uint8_t>> Camera::photograph(const Plant& plant) {
  taken_.push_back(take(plant));
  if (static_cast<int>(taken_.size()) > options_.delay + 1) taken_.pop_front();
  return taken_.front();
}

/// @return nothing if it is lost
std::optional<Camera::Picture> Camera::take(const Plant& plant) {
  const int frame = frame_++;
  const double draw = std::uniform_real_distribution<double>(0.0, 1.0)(rng_);
  if (frame > 0 && draw < options_.drop_rate) return std::nullopt;
  const double turns = frame * plant.dt() / options_.brightness_period;
  const double brightness = 1.0 + options_.brightness_drift * std::sin(kTwoPi * turns + phase_);
  return expose(plant, plant.state(), brightness, &noise_);
}

std::vector<std::uint8_t> Camera::photographGoal(const Plant& plant) const {
  std::mt19937_64 noise = randomStream(TrialId(), StreamRole::kGoalNoise);
  return expose(plant, plant.goalState(), /*brightness=*/1.0, &noise);
}

Camera::Picture Camera::expose(const Plant& plant, const Eigen::VectorXd& state, double brightness,
                               std::mt19937_64* noise) const {
  const Picture picture = plant.render(state);
  if (picture.size() != background_.size()) {
    throw std::invalid_argument("camera: the plant's picture must have " +
                                std::to_string(background_.size()) + " pixels, got " +
                                std::to_string(picture.size()));
  }
  const bool cluttered = options_.clutter > 0.0;
  if (brightness == 1.0 && !cluttered && options_.noise_std == 0.0) return picture;
  const Picture cover = cluttered ? plant.coverage(state) : Picture();
  if (cluttered && cover.empty()) {
    throw std::invalid_argument(
        "camera/clutter must be 0 before a plant that does not say what it covers: implement its "
        "cover()");
  }
  std::normal_distribution<double> standard_normal;
  Picture bytes(picture.size());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    double grey = picture[i] / 255.0;
    if (cluttered) grey += (1.0 - cover[i] / 255.0) * background_[i];
    grey *= brightness;
    if (options_.noise_std > 0.0) grey += options_.noise_std * standard_normal(*noise);
    bytes[i] = static_cast<std::uint8_t>(255.0 * std::clamp(grey, 0.0, 1.0) + 0.5);
  }
  return bytes;
}

}  // namespace ddm
