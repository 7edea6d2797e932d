// Tests of stamps: which images are accepted, and which are selected for the control loop.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/stamp_check.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "ddm_robot/torque_gate.h"

namespace ddm {
namespace {

constexpr double kDt = 0.2;
constexpr double kPeriod = 1.0 / 30.0;
constexpr double kHour = 3600.0;
const Stamp kEpoch = std::chrono::hours(24 * 365 * 50);  // wall clock at the begin of a test

SteadyTime at(double seconds) { return SteadyTime(std::chrono::hours(5) + fromSeconds(seconds)); }
Stamp clockAt(double seconds) { return kEpoch + fromSeconds(seconds); }

/// Camera and motor of a robot, connected as in robot_node but without messages.
class Robot {
 public:
  Robot() {
    EXPECT_EQ(gate_.arm(at(0.0)), "");
    gate_.effort(at(0.0));
  }

  /// An image arrives, and its torque follows after 10 ms.
  /// @param error  error of the clock that stamps the image [s]
  /// @param delay  delay beyond the usual 15 ms from camera to node [s]
  /// @return       whether the image was accepted
  bool image(double now, double error = 0.0, double delay = 0.0) {
    const Stamp stamp = clockAt(now - 0.015 - delay + error);
    if (!stamps_.take(at(now), clockAt(now), stamp).empty()) return false;
    if (!picker_.pick(stamp)) return true;
    gate_.showImage(stamps_.taken(), stamp);
    gate_.takeTorque(at(now + 0.01), stamp, {2.0});
    return true;
  }

  /// Shows 30 images per second.
  /// @return time at which the next image is due
  double images(double begin, double end, double error = 0.0) {
    double now = begin;
    for (; now < end; now += kPeriod) image(now, error);
    return now;
  }

  /// @return time for which the motor still receives a torque, checked every 10 ms [s]
  double timeUntilZero(double now) {
    double passed = 0.0;
    while (gate_.effort(at(now + passed)).at(0) != 0.0 && passed < 10.0) passed += 0.01;
    return passed;
  }

  double effort(double now) { return gate_.effort(at(now)).at(0); }
  void restart() {
    stamps_.restart();
    picker_.restart();
  }

  RobotOptions options_;
  TorqueGate gate_{options_};
  StampCheck stamps_{kDt};
  ImagePicker picker_{kDt};
};

TEST(StampCheck, AfterAnImageFromTheFutureAndThenSilenceTheMotorStopsInTwentyOfTwentyTries) {
  for (int i = 0; i < 20; ++i) {
    Robot robot;
    const double last = robot.images(0.0, 2.0 + 0.011 * i) - kPeriod;
    ASSERT_EQ(robot.effort(last + 0.01), 2.0);
    EXPECT_FALSE(robot.image(last + kPeriod, kHour));
    EXPECT_LE(0.01 + robot.timeUntilZero(last + 0.01), 2.0 * kDt + 0.05) << "try " << i;
    EXPECT_EQ(robot.stamps_.numRefused(), 1);
  }
}

TEST(StampCheck, AClockThatIsSetForwardOrBackStopsTheMotorUntilItIsRightAgain) {
  for (const double error : {kHour, -kHour, 0.5, -0.5}) {
    Robot robot;
    double now = robot.images(0.0, 2.0);
    const int answers = robot.gate_.numAnswers();
    now = robot.images(now, now + 0.45, error);
    EXPECT_EQ(robot.effort(now), 0.0) << error;
    EXPECT_EQ(robot.gate_.numAnswers(), answers) << error;
    now = robot.images(now, now + 0.5);
    EXPECT_EQ(robot.effort(now), 2.0) << error;
  }
}

TEST(StampCheck, TheFirstImageIsComparedWithTheClockOfTheMachine) {
  for (const double error : {kHour, -kHour, 0.21, -0.21}) {
    StampCheck check(kDt);
    EXPECT_NE(check.take(at(0.0), clockAt(0.0), clockAt(error)), "") << error;
    EXPECT_EQ(check.take(at(0.1), clockAt(0.1), clockAt(0.1)), "") << "nothing of it is remembered";
  }
  StampCheck check(kDt);
  EXPECT_NE(check.take(at(0.0), clockAt(0.0), Stamp(0)), "") << "a stamp that nobody has set";
}

TEST(StampCheck, AClockThatDriftsByAMillisecondPerSecondNeverStopsATrial) {
  for (const double drift : {1e-3, -1e-3}) {
    Robot robot;
    for (double now = 0.0; now < 1800.0; now += kPeriod) {
      ASSERT_TRUE(robot.image(now, drift * now)) << now;
      ASSERT_EQ(robot.effort(now + 0.011), 2.0) << now;
    }
    EXPECT_EQ(robot.gate_.numMisses(), 0);
  }
}

TEST(StampCheck, ImagesThatComeLateAreAcceptedAndSoIsTheNextOneInTime) {
  for (const double delay : {0.5 * kDt, 1.2 * kDt, 5.0 * kDt}) {
    Robot robot;
    double now = robot.images(0.0, 2.0);
    EXPECT_TRUE(robot.image(now + delay, 0.0, delay)) << delay;
    now = robot.images(now + delay + kPeriod, now + delay + 1.0);
    EXPECT_EQ(robot.effort(now), 2.0) << delay;
    EXPECT_EQ(robot.stamps_.numRefused(), 0) << delay;
  }
}

TEST(StampCheck, AfterTenSecondsOfDelayTheFirstImageInTimeIsNotTakenForAJump) {
  Robot robot;
  double now = robot.images(0.0, 2.0);
  for (const double end = now + 10.0; now < end; now += kPeriod) {
    robot.image(now, 0.0, 3.0 * kDt);
    if (end - now > 9.5) continue;
    EXPECT_EQ(robot.effort(now), 0.0) << "it is late however long it lasts";
  }
  now = robot.images(now, now + 2.0);
  EXPECT_EQ(robot.effort(now), 2.0);
}

TEST(StampCheck, AJitteryTransportRefusesNothing) {
  std::mt19937_64 engine(1);
  std::exponential_distribution<double> delay(1.0 / 0.02);
  StampCheck check(kDt);
  double arrival = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double taken = i * kPeriod;
    arrival = std::max(arrival, taken + delay(engine));  // a transport keeps the order of images
    ASSERT_EQ(check.take(at(arrival), clockAt(arrival), clockAt(taken)), "") << i;
    ASSERT_LE(check.taken(), at(arrival));
  }
}

TEST(StampCheck, TellsWhenALateImageWasTakenAndNeverMoreThanItsArrival) {
  StampCheck check(kDt);
  for (int i = 0; i < 50; ++i) {
    const double now = i * kPeriod;
    ASSERT_EQ(check.take(at(now), clockAt(now), clockAt(now - 0.05)), "");
    EXPECT_NEAR(toSeconds(at(now) - check.taken()), 0.0, 1e-6) << "the usual delay is not known";
  }
  ASSERT_EQ(check.take(at(2.0), clockAt(2.0), clockAt(1.85)), "");
  EXPECT_NEAR(toSeconds(at(2.0) - check.taken()), 0.1, 1e-6);
  ASSERT_EQ(check.take(at(2.1), clockAt(2.1), clockAt(2.2)), "");
  EXPECT_EQ(check.taken(), at(2.1));
}

TEST(StampCheck, AnImageThatComesTwiceOrOutOfOrderIsRefusedOnce) {
  StampCheck check(kDt);
  EXPECT_EQ(check.take(at(0.0), clockAt(0.0), clockAt(0.0)), "");
  EXPECT_NE(check.take(at(0.01), clockAt(0.01), clockAt(0.0)), "");
  EXPECT_NE(check.take(at(0.02), clockAt(0.02), clockAt(-0.01)), "");
  EXPECT_EQ(check.take(at(0.03), clockAt(0.03), clockAt(0.03)), "");
  EXPECT_EQ(check.numRefused(), 2);
}

/// Intervals between the selected images of a sequence of images at these times [s].
std::vector<double> stepsOf(ImagePicker* picker, const std::vector<double>& images) {
  std::vector<double> picked;
  for (const double image : images) {
    if (picker->pick(clockAt(image))) picked.push_back(image);
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < picked.size(); ++i) steps.push_back(picked[i] - picked[i - 1]);
  return steps;
}

std::vector<double> camera(double rate, double jitter = 0.0) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> error(-jitter, jitter);
  std::vector<double> images;
  for (int i = 0; i < 20 * rate; ++i) images.push_back(i / rate + error(rng));
  return images;
}

TEST(ImagePicker, TakesEverySixthImageOfThirtyHertzAtDtOfAFifth) {
  for (const double rate : {29.97, 30.0, 30.03}) {
    for (const double jitter : {0.0, 0.006}) {
      ImagePicker picker(0.2);
      const std::vector<double> steps = stepsOf(&picker, camera(rate, jitter));
      ASSERT_GT(steps.size(), 95u);
      for (const double step : steps) EXPECT_NEAR(step, 6.0 / rate, 2.0 * jitter + 1e-6);
    }
  }
}

TEST(ImagePicker, StepsAreEquallyLongWhereDtIsNoMultipleOfThePeriod) {
  ImagePicker picker(0.2);
  for (const double step : stepsOf(&picker, camera(24.0))) EXPECT_NEAR(step, 5.0 / 24.0, 1e-6);
  EXPECT_NEAR(picker.step(), 5.0 / 24.0, 1e-6);
}

TEST(ImagePicker, LostImagesAndPausesDoNotShortenSteps) {
  ImagePicker picker(0.2);
  std::vector<double> images = camera(30.0);
  images.erase(images.begin() + 32, images.begin() + 35);
  for (std::size_t i = 100; i < images.size(); ++i) images[i] += 60.0;
  for (const double step : stepsOf(&picker, images)) EXPECT_GT(step, 0.199);
}

TEST(ImagePicker, ARestartTakesTheNextImageAndCountsFromIt) {
  ImagePicker picker(0.2);
  for (int i = 0; i <= 8; ++i) picker.pick(clockAt(i / 30.0));
  EXPECT_FALSE(picker.pick(clockAt(8.0 / 30.0))) << "no image is taken twice";
  picker.restart();
  const std::vector<double> steps = stepsOf(&picker, {9.0 / 30, 10.0 / 30, 14.0 / 30, 15.0 / 30});
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_NEAR(steps[0], 6.0 / 30, 1e-6);
}

}  // namespace
}  // namespace ddm
