// Tests of which frames of a camera are acted on.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/frame_picker.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace ddm {
namespace {

Stamp stampAt(double seconds) { return std::chrono::seconds(1700000000) + fromSeconds(seconds); }

/// Steps between the frames that are picked of those at these times [s].
std::vector<double> stepsOf(FramePicker* picker, const std::vector<double>& frames) {
  std::vector<double> picked;
  for (const double frame : frames) {
    if (picker->pick(stampAt(frame))) picked.push_back(frame);
  }
  std::vector<double> steps;
  for (size_t i = 1; i < picked.size(); ++i) steps.push_back(picked[i] - picked[i - 1]);
  return steps;
}

std::vector<double> camera(double rate, double jitter = 0.0) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> error(-jitter, jitter);
  std::vector<double> frames;
  for (int i = 0; i < 20 * rate; ++i) frames.push_back(i / rate + error(rng));
  return frames;
}

TEST(FramePicker, TakesEverySixthFrameOfThirtyHertzAtDtOfAFifth) {
  for (const double rate : {29.97, 30.0, 30.03}) {
    for (const double jitter : {0.0, 0.006}) {
      FramePicker picker(0.2);
      const std::vector<double> steps = stepsOf(&picker, camera(rate, jitter));
      ASSERT_GT(steps.size(), 95u);
      for (const double step : steps) EXPECT_NEAR(step, 6.0 / rate, 2.0 * jitter + 1e-6);
    }
  }
}

TEST(FramePicker, StepsAreEquallyLongWhereDtIsNoMultipleOfThePeriod) {
  FramePicker picker(0.2);
  for (const double step : stepsOf(&picker, camera(24.0))) EXPECT_NEAR(step, 5.0 / 24.0, 1e-6);
  EXPECT_NEAR(picker.step(), 5.0 / 24.0, 1e-6);
}

TEST(FramePicker, LostFramesAndPausesDoNotShortenSteps) {
  FramePicker picker(0.2);
  std::vector<double> frames = camera(30.0);
  frames.erase(frames.begin() + 32, frames.begin() + 35);
  for (size_t i = 100; i < frames.size(); ++i) frames[i] += 60.0;
  for (const double step : stepsOf(&picker, frames)) EXPECT_GT(step, 0.199);
}

TEST(FramePicker, ARestartTakesTheNextFrameAndCountsFromIt) {
  FramePicker picker(0.2);
  for (int i = 0; i <= 8; ++i) picker.pick(stampAt(i / 30.0));
  EXPECT_FALSE(picker.pick(stampAt(8.0 / 30.0))) << "no frame is taken twice";
  picker.restart();
  const std::vector<double> steps = stepsOf(&picker, {9.0 / 30, 10.0 / 30, 14.0 / 30, 15.0 / 30});
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_NEAR(steps[0], 6.0 / 30, 1e-6);
}

}  // namespace
}  // namespace ddm
