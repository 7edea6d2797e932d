// Tests of the camera: the effect of each disturbance on the images, and their reproducibility.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "ddm_plant_plugin/testing/toy_plant.h"
#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"

namespace ddm {
namespace {

using testing::allNuisances;
using Bytes = std::vector<std::uint8_t>;

constexpr double kDt = 0.2;  // [s]

/// The rendered image of the current state.
RenderedImage viewOf(const Plant& plant) { return plant.render(plant.state()); }

RenderedImage hangingRod() { return viewOf(Pendulum{PendulumOptions()}); }

/// An image that shows the background only.
RenderedImage black() { return testing::plainImage(51, 0); }

/// The next camera image; empty if the image is lost.
Bytes captureOf(Camera* camera, const RenderedImage& rendered) {
  const std::optional<RenderedImage> captured = camera->capture(rendered);
  return captured ? captured->bytes : Bytes();
}

/// The first image of a new camera.
Bytes captureOf(const CameraOptions& options, const RenderedImage& rendered) {
  Camera camera(options, kDt);
  return captureOf(&camera, rendered);
}

/// Images of a swinging pendulum, one for each step; empty where the camera loses an image.
/// @param camera  null for the rendered images themselves
std::vector<Bytes> film(Camera* camera, int num_steps) {
  Pendulum plant{PendulumOptions()};
  std::vector<Bytes> out;
  for (int step = 0; step < num_steps; ++step) {
    out.push_back(camera ? captureOf(camera, viewOf(plant)) : viewOf(plant).bytes);
    plant.step(Eigen::VectorXd::Constant(1, 3.0));
  }
  return out;
}

/// FNV-1a hash of all bytes of all images.
std::uint64_t hashOf(const std::vector<Bytes>& frames) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const Bytes& frame : frames) {
    for (const std::uint8_t byte : frame) hash = (hash ^ byte) * 1099511628211ULL;
  }
  return hash;
}

std::vector<bool> lost(const std::vector<Bytes>& frames) {
  std::vector<bool> out;
  for (const Bytes& frame : frames) out.push_back(frame.empty());
  return out;
}

/// Committed results were computed from these images.
TEST(Camera, ShowsTheSameImagesAsEverWhereAllNuisancesAreOff) {
  Camera camera(CameraOptions(), kDt);
  EXPECT_EQ(hashOf(film(&camera, 20)), 0xa5dc86f41e3e2aafULL);
  MovingTile tile{MovingTileOptions()};
  camera.begin({0, 0, false});
  std::vector<Bytes> frames;
  for (int step = 0; step < 20; ++step) {
    frames.push_back(captureOf(&camera, viewOf(tile)));
    tile.step(Eigen::Vector2d(1.7, -2.3));
  }
  EXPECT_EQ(hashOf(frames), 0xc521c9e3ec638024ULL);
}

/// An image that differs from those of this package's plants: wide, in colour, black on its left
/// half.
RenderedImage colourful() {
  RenderedImage rendered{40, 10, 3, {}, {}};
  for (int i = 0; i < rendered.height; ++i) {
    for (int j = 0; j < rendered.width; ++j) {
      const bool plant = j >= 20;
      rendered.cover.push_back(plant ? 255 : 0);
      const Bytes colour = plant ? Bytes{200, 100, 50} : Bytes{0, 0, 0};
      rendered.bytes.insert(rendered.bytes.end(), colour.begin(), colour.end());
    }
  }
  return rendered;
}

TEST(Camera, PutsGreyClutterBehindAPlantInColour) {
  CameraOptions options;
  options.clutter = 0.5;
  const RenderedImage rendered = colourful();
  const Bytes image = captureOf(options, rendered);
  RenderedImage grey{40, 10, 1, Bytes(400, 0), Bytes(400, 0)};
  const Bytes background = captureOf(options, grey);
  EXPECT_NEAR(*std::max_element(background.begin(), background.end()), 127.5, 1.0);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const std::size_t pixel = i / 3;
    ASSERT_EQ(image[i], pixel % 40 >= 20 ? rendered.bytes[i] : background[pixel]) << i;
  }
}

TEST(Camera, AddsNoiseOfTheGivenSpreadToEachFrameIndependently) {
  CameraOptions options;
  options.noise_std = 0.1;
  Camera camera(options, kDt);
  const RenderedImage rod = hangingRod();
  const Bytes& clean = rod.bytes;
  std::vector<double> noise;  // of grey pixels, which are never clipped
  std::vector<double> before;
  double sum = 0.0, squares = 0.0, with_last_frame = 0.0;
  for (int frame = 0; frame < 400; ++frame) {
    const Bytes image = captureOf(&camera, rod);
    noise.clear();
    for (std::size_t i = 0; i < clean.size(); ++i) {
      if (clean[i] > 110 && clean[i] < 145) noise.push_back((image[i] - clean[i]) / 255.0);
    }
    for (std::size_t i = 0; i < noise.size(); ++i) {
      sum += noise[i];
      squares += noise[i] * noise[i];
      if (!before.empty()) with_last_frame += noise[i] * before[i];
    }
    before = noise;
  }
  const double n = 400.0 * static_cast<double>(noise.size());
  ASSERT_GT(n, 10000.0);
  EXPECT_NEAR(sum / n, 0.0, 5 * 0.1 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.1, 5 * 0.1 / std::sqrt(2 * n));
  EXPECT_NEAR(with_last_frame / n / 0.01, 0.0, 5 / std::sqrt(n));
}

TEST(Camera, ChangesTheBrightnessOfAllPixelsAlikeInASineOfTheGivenPeriod) {
  CameraOptions options;
  options.brightness_drift = 0.2;
  Camera camera(options, 0.5);  // a period of the brightness has 40 steps
  const RenderedImage rod = hangingRod();
  const Bytes& clean = rod.bytes;
  std::vector<double> factor;
  for (int t = 0; t < 80; ++t) {
    const Bytes image = captureOf(&camera, rod);
    const auto grey = std::find_if(clean.begin(), clean.end(), [](int k) { return k > 150; });
    factor.push_back(static_cast<double>(image[grey - clean.begin()]) / *grey);
    for (std::size_t i = 0; i < clean.size(); ++i) {
      ASSERT_NEAR(image[i], std::min(255.0, clean[i] * factor.back()), 2.0) << t << ", " << i;
    }
  }
  for (int t = 0; t < 40; ++t) {
    EXPECT_EQ(factor[t], factor[t + 40]);
    EXPECT_NEAR(factor[t] - 1.0, 1.0 - factor[(t + 20) % 40], 0.01);  // half a period later
    const double quarter = factor[(t + 10) % 40] - 1.0;
    EXPECT_NEAR(std::hypot(factor[t] - 1.0, quarter), 0.2, 0.01);  // sine and cosine
  }
}

TEST(Camera, ShowsTheSameClutterInAllRunsAndNothingElseWhereThereIsNoPlant) {
  CameraOptions options;
  options.clutter = 0.6;
  Camera camera(options, kDt);
  const Bytes background = captureOf(&camera, black());
  EXPECT_EQ(*std::max_element(background.begin(), background.end()), 153);  // 0.6 * 255
  const std::set<std::uint8_t> greys(background.begin(), background.end());
  EXPECT_GT(greys.size(), 50U);
  camera.begin({7, 3, true});
  EXPECT_EQ(captureOf(&camera, black()), background);
}

TEST(Camera, RefusesClutterBehindAPlantThatDoesNotSayWhatItCovers) {
  RenderedImage rendered = black();
  rendered.cover.clear();
  CameraOptions options;
  EXPECT_NO_THROW(Camera(options, kDt).capture(rendered));
  options.clutter = 0.6;
  EXPECT_THROW(Camera(options, kDt).capture(rendered), std::invalid_argument);
  EXPECT_THROW(Camera(options, kDt).captureGoal(rendered), std::invalid_argument);
}

TEST(Camera, ShowsTheStateOfSoManyFramesAgoAndAtFirstThatOfTheFirstFrame) {
  const std::vector<Bytes> clean = film(nullptr, 20);
  for (const int delay : {1, 3}) {
    CameraOptions options;
    options.delay = delay;
    Camera camera(options, kDt);
    for (int run = 0; run < 2; ++run) {  // begin() discards the images that wait for their delay
      camera.begin({0, 0, false});
      const std::vector<Bytes> late = film(&camera, 20);
      for (int t = 0; t < 20; ++t) EXPECT_EQ(late[t], clean[std::max(0, t - delay)]) << t;
    }
  }
}

TEST(Camera, LosesFramesAtTheGivenRateButNeverTheFirst) {
  CameraOptions options;
  options.drop_rate = 0.1;
  Camera camera(options, kDt);
  const RenderedImage rod = hangingRod();
  int num_lost = 0;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    camera.begin({1, trial, false});
    ASSERT_TRUE(camera.capture(rod)) << trial;
    for (int t = 1; t < 100; ++t) num_lost += camera.capture(rod) ? 0 : 1;
  }
  const double n = 200 * 99;
  EXPECT_NEAR(num_lost / n, 0.1, 5 * std::sqrt(0.1 * 0.9 / n));
}

TEST(Camera, GivesTheSameImagesInTheSameRunAndOthersInAnother) {
  Camera camera(allNuisances(), kDt);
  std::set<std::vector<Bytes>> films;
  std::set<std::vector<bool>> losses;
  for (const bool evaluation : {false, true}) {
    for (const std::uint32_t trial : {0U, 1U}) {
      for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32}) {
        camera.begin({seed, trial, evaluation});
        const std::vector<Bytes> first = film(&camera, 40);
        Camera other(allNuisances(), kDt);
        other.begin({seed, trial, evaluation});
        EXPECT_EQ(film(&other, 40), first);
        films.insert(first);
        losses.insert(lost(first));
      }
    }
  }
  EXPECT_EQ(films.size(), 12U);
  EXPECT_EQ(losses.size(), 12U);
}

TEST(Camera, TakesTheSameNoisyGoalImageAtAnyTimeAndChangesNoImageByIt) {
  CameraOptions options = allNuisances();
  Camera camera(options, kDt);
  const RenderedImage rod = hangingRod();
  const Bytes goal = camera.captureGoal(rod).bytes;
  camera.begin({5, 4, true});
  film(&camera, 10);
  EXPECT_EQ(camera.captureGoal(rod).bytes, goal);
  Camera undisturbed(allNuisances(), kDt);
  undisturbed.begin({5, 4, true});
  camera.begin({5, 4, true});
  camera.captureGoal(rod);
  EXPECT_EQ(film(&camera, 20), film(&undisturbed, 20));
  options.noise_std = 0.0;
  const Bytes quiet = Camera(options, kDt).captureGoal(rod).bytes;
  EXPECT_NE(quiet, goal);
  options.brightness_drift = 0.0;
  EXPECT_EQ(Camera(options, kDt).captureGoal(rod).bytes, quiet) << "it is never dark";
}

}  // namespace
}  // namespace ddm
