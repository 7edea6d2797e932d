// Tests of the camera: the effect of each disturbance on the images, and their reproducibility.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "ddm_sim/angles.h"
#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"
#include "ddm_sim/testing/toy_plant.h"

namespace ddm {
namespace {

using testing::allNuisances;
using Bytes = std::vector<std::uint8_t>;

constexpr double kDt = 0.2;  // [s]

/// The rendered image of the current state.
Picture viewOf(const Plant& plant) { return plant.render(plant.state()); }

Picture hangingRod() { return viewOf(Pendulum{PendulumOptions()}); }

/// An image that shows the background only.
Picture black() { return testing::plainPicture(51, 0); }

/// The next camera image; empty if the image is lost.
Bytes photographOf(Camera* camera, const Picture& picture) {
  const std::optional<Picture> photograph = camera->photograph(picture);
  return photograph ? photograph->bytes : Bytes();
}

/// The first image of a new camera.
Bytes photographOf(const CameraOptions& options, const Picture& picture) {
  Camera camera(options, kDt);
  return photographOf(&camera, picture);
}

/// Images of a swinging pendulum, one for each step; empty where the camera loses an image.
/// @param camera  null for the rendered images themselves
std::vector<Bytes> film(Camera* camera, int num_steps) {
  Pendulum plant{PendulumOptions()};
  std::vector<Bytes> out;
  for (int step = 0; step < num_steps; ++step) {
    out.push_back(camera ? photographOf(camera, viewOf(plant)) : viewOf(plant).bytes);
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
TEST(Camera, ShowsTheSamePicturesAsEverWhereAllNuisancesAreOff) {
  Camera camera(CameraOptions(), kDt);
  EXPECT_EQ(hashOf(film(&camera, 20)), 0xa5dc86f41e3e2aafULL);
  MovingTile tile{MovingTileOptions()};
  camera.begin(0, 0, false);
  std::vector<Bytes> frames;
  for (int step = 0; step < 20; ++step) {
    frames.push_back(photographOf(&camera, viewOf(tile)));
    tile.step(Eigen::Vector2d(1.7, -2.3));
  }
  EXPECT_EQ(hashOf(frames), 0xc521c9e3ec638024ULL);
}

/// An image that differs from those of this package's plants: wide, in colour, black on its left
/// half.
Picture colourful() {
  Picture picture{40, 10, 3, {}, {}};
  for (int i = 0; i < picture.height; ++i) {
    for (int j = 0; j < picture.width; ++j) {
      const bool plant = j >= 20;
      picture.cover.push_back(plant ? 255 : 0);
      const Bytes colour = plant ? Bytes{200, 100, 50} : Bytes{0, 0, 0};
      picture.bytes.insert(picture.bytes.end(), colour.begin(), colour.end());
    }
  }
  return picture;
}

TEST(Camera, PutsGreyClutterBehindAPlantInColour) {
  CameraOptions options;
  options.clutter = 0.5;
  const Picture picture = colourful();
  const Bytes image = photographOf(options, picture);
  Picture grey{40, 10, 1, Bytes(400, 0), Bytes(400, 0)};
  const Bytes background = photographOf(options, grey);
  EXPECT_NEAR(*std::max_element(background.begin(), background.end()), 127.5, 1.0);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const std::size_t pixel = i / 3;
    ASSERT_EQ(image[i], pixel % 40 >= 20 ? picture.bytes[i] : background[pixel]) << i;
  }
}

TEST(Camera, AddsIndependentNoiseOfTheGivenSpreadToEachPixelOfEachFrame) {
  CameraOptions options;
  options.noise_std = 0.1;
  Camera camera(options, kDt);
  const Picture rod = hangingRod();
  const Bytes& clean = rod.bytes;
  std::vector<double> noise;  // of grey pixels, which are never clipped
  std::vector<double> before;
  double sum = 0.0, squares = 0.0, with_last_frame = 0.0, with_last_pixel = 0.0;
  for (int frame = 0; frame < 400; ++frame) {
    const Bytes image = photographOf(&camera, rod);
    noise.clear();
    for (std::size_t i = 0; i < clean.size(); ++i) {
      if (clean[i] > 110 && clean[i] < 145) noise.push_back((image[i] - clean[i]) / 255.0);
    }
    for (std::size_t i = 0; i < noise.size(); ++i) {
      sum += noise[i];
      squares += noise[i] * noise[i];
      if (i > 0) with_last_pixel += noise[i] * noise[i - 1];
      if (!before.empty()) with_last_frame += noise[i] * before[i];
    }
    before = noise;
  }
  const double n = 400.0 * static_cast<double>(noise.size());
  ASSERT_GT(n, 10000.0);
  EXPECT_NEAR(sum / n, 0.0, 5 * 0.1 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.1, 5 * 0.1 / std::sqrt(2 * n));
  EXPECT_NEAR(with_last_frame / n / 0.01, 0.0, 5 / std::sqrt(n));
  EXPECT_NEAR(with_last_pixel / n / 0.01, 0.0, 5 / std::sqrt(n));
}

TEST(Camera, ChangesTheBrightnessOfAllPixelsAlikeInASineOfTheGivenPeriod) {
  CameraOptions options;
  options.brightness_drift = 0.2;
  Camera camera(options, 0.5);  // a period of the brightness has 40 steps
  const Picture rod = hangingRod();
  const Bytes& clean = rod.bytes;
  std::vector<double> factor;
  for (int t = 0; t < 80; ++t) {
    const Bytes image = photographOf(&camera, rod);
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

TEST(Camera, ShowsClutterAloneWhereThereIsNoPlant) {
  CameraOptions options;
  options.clutter = 0.6;
  const Bytes background = photographOf(options, black());
  EXPECT_EQ(*std::max_element(background.begin(), background.end()), 153);  // 0.6 * 255
  const std::set<std::uint8_t> greys(background.begin(), background.end());
  EXPECT_GT(greys.size(), 50U);
  int edges = 0, slopes = 0;
  for (int i = 0; i < 51; ++i) {
    for (int j = 1; j < 51; ++j) {
      const int jump = std::abs(background[i * 51 + j] - background[i * 51 + j - 1]);
      edges += jump >= 40 ? 1 : 0;
      slopes += jump >= 1 && jump < 8 ? 1 : 0;
    }
  }
  EXPECT_GT(edges, 40);    // sharp shapes; blurred shapes alone have a few
  EXPECT_GT(slopes, 400);  // blurred shapes; sharp shapes alone have half as many
}

TEST(Camera, RefusesClutterBehindAPlantThatDoesNotSayWhatItCovers) {
  Picture picture = black();
  picture.cover.clear();
  CameraOptions options;
  EXPECT_NO_THROW(Camera(options, kDt).photograph(picture));
  options.clutter = 0.6;
  EXPECT_THROW(Camera(options, kDt).photograph(picture), std::invalid_argument);
  EXPECT_THROW(Camera(options, kDt).photographGoal(picture), std::invalid_argument);
}

TEST(Camera, HasOneBackgroundForAllRuns) {
  CameraOptions options;
  options.clutter = 0.6;
  Camera camera(options, kDt);
  const Bytes background = photographOf(&camera, black());
  camera.begin(7, 3, true);
  EXPECT_EQ(photographOf(&camera, black()), background);
}

TEST(Camera, ShowsTheStateOfSoManyFramesAgoAndAtFirstThatOfTheFirstFrame) {
  const std::vector<Bytes> clean = film(nullptr, 20);
  for (const int delay : {1, 3}) {
    CameraOptions options;
    options.delay = delay;
    Camera camera(options, kDt);
    for (int run = 0; run < 2; ++run) {  // begin() discards the images that wait for their delay
      camera.begin(0, 0, false);
      const std::vector<Bytes> late = film(&camera, 20);
      for (int t = 0; t < 20; ++t) EXPECT_EQ(late[t], clean[std::max(0, t - delay)]) << t;
    }
  }
}

TEST(Camera, LosesFramesAtTheGivenRateButNeverTheFirst) {
  CameraOptions options;
  options.drop_rate = 0.1;
  Camera camera(options, kDt);
  const Picture rod = hangingRod();
  int num_lost = 0;
  for (std::uint32_t trial = 0; trial < 200; ++trial) {
    camera.begin(1, trial, false);
    ASSERT_TRUE(camera.photograph(rod)) << trial;
    for (int t = 1; t < 100; ++t) num_lost += camera.photograph(rod) ? 0 : 1;
  }
  const double n = 200 * 99;
  EXPECT_NEAR(num_lost / n, 0.1, 5 * std::sqrt(0.1 * 0.9 / n));
}

TEST(Camera, NoiseChangesNeitherWhichFramesAreLostNorTheBrightness) {
  CameraOptions options;
  options.drop_rate = 0.3;
  options.brightness_drift = 0.2;
  Camera without(options, kDt);
  options.noise_std = 1e-9;
  Camera with(options, kDt);
  without.begin(3, 2, true);
  with.begin(3, 2, true);
  EXPECT_EQ(film(&with, 100), film(&without, 100));
}

TEST(Camera, GivesTheSamePhotographsInTheSameRunAndOthersInAnother) {
  Camera camera(allNuisances(), kDt);
  std::set<std::vector<Bytes>> films;
  std::set<std::vector<bool>> losses;
  for (const bool evaluation : {false, true}) {
    for (const std::uint32_t trial : {0U, 1U}) {
      for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32}) {
        camera.begin(seed, trial, evaluation);
        const std::vector<Bytes> first = film(&camera, 40);
        Camera other(allNuisances(), kDt);
        other.begin(seed, trial, evaluation);
        EXPECT_EQ(film(&other, 40), first);
        films.insert(first);
        losses.insert(lost(first));
      }
    }
  }
  EXPECT_EQ(films.size(), 12U);
  EXPECT_EQ(losses.size(), 12U);
}

TEST(Camera, TakesTheSameNoisyGoalImageAtAnyTimeAndChangesNoPhotographByIt) {
  CameraOptions options = allNuisances();
  Camera camera(options, kDt);
  const Picture rod = hangingRod();
  const Bytes goal = camera.photographGoal(rod).bytes;
  camera.begin(5, 4, true);
  film(&camera, 10);
  EXPECT_EQ(camera.photographGoal(rod).bytes, goal);
  Camera undisturbed(allNuisances(), kDt);
  undisturbed.begin(5, 4, true);
  camera.begin(5, 4, true);
  camera.photographGoal(rod);
  EXPECT_EQ(film(&camera, 20), film(&undisturbed, 20));
  options.noise_std = 0.0;
  const Bytes quiet = Camera(options, kDt).photographGoal(rod).bytes;
  EXPECT_NE(quiet, goal);
  options.brightness_drift = 0.0;
  options.delay = 0;
  options.drop_rate = 0.0;
  // The goal image is neither darkened, nor delayed, nor lost.
  EXPECT_EQ(Camera(options, kDt).photographGoal(rod).bytes, quiet);
}

}  // namespace
}  // namespace ddm
