// Tests of the gate between a controller and a motor: which torques act, and what sets zero torque.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/torque_gate.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace ddm {
namespace {

using State = TorqueGate::State;

/// dt is 200 ms; times are in milliseconds since an arbitrary moment. The stamps of images are
/// unrelated to these times, so that no deadline can depend on stamps.
class TorqueGateTest : public ::testing::Test {
 protected:
  static SteadyTime at(int ms) {
    return SteadyTime(std::chrono::hours(1) + std::chrono::milliseconds(ms));
  }
  static Stamp stampOf(int ms) { return std::chrono::hours(7 * (ms % 1000)); }
  void showImage(int ms) { gate_.showImage(at(ms), stampOf(ms)); }

  void SetUp() override { gate_.effort(at(0)); }

  bool answer(int now, int stamp, double torque) {
    return gate_.takeTorque(at(now), stampOf(stamp), {torque});
  }
  /// The effort of the single motor.
  double effort(int now) { return gate_.effort(at(now)).at(0); }

  /// Arms the gate and begins an episode with the torque 2 for the image at time 0.
  void follow() {
    ASSERT_EQ(gate_.arm(at(0)), "");
    showImage(0);
    ASSERT_TRUE(answer(20, 0, 2.0));
    ASSERT_EQ(effort(20), 2.0);
  }
  /// As follow(), with other options.
  void followWith(const RobotOptions& options) {
    gate_ = TorqueGate(options);
    gate_.effort(at(0));
    ASSERT_EQ(gate_.arm(at(0)), "");
    showImage(0);
  }

  TorqueGate gate_{RobotOptions()};
};

TEST_F(TorqueGateTest, MotorsAreOffUntilTheyAreArmed) {
  showImage(0);
  EXPECT_FALSE(answer(10, 0, 2.0));
  EXPECT_EQ(effort(20), 0.0);
  EXPECT_FALSE(gate_.armed());
  EXPECT_NE(gate_.describe().find("enable"), std::string::npos);
}

TEST_F(TorqueGateTest, ATorqueInTimeActsUntilTheNext) {
  follow();
  EXPECT_EQ(gate_.state(), State::kFollowing);
  showImage(200);
  EXPECT_EQ(effort(399), 2.0);
  EXPECT_TRUE(answer(400, 200, -1.0));  // the latest time at which the torque is accepted
  EXPECT_EQ(effort(400), -1.0);
  EXPECT_EQ(gate_.numMisses(), 0);
  EXPECT_EQ(gate_.numAnswers(), 2);
}

TEST_F(TorqueGateTest, WithoutAnAnswerWithinDtTheTorqueIsZeroAndTheLateOneDoesNotAct) {
  follow();
  showImage(200);
  EXPECT_EQ(effort(401), 0.0);
  EXPECT_EQ(gate_.state(), State::kLate);
  EXPECT_FALSE(answer(402, 200, 3.0));
  EXPECT_EQ(effort(403), 0.0);
  EXPECT_EQ(gate_.numMisses(), 1);
  showImage(500);
  showImage(650);
  EXPECT_TRUE(answer(660, 650, 1.5)) << "the next one in time acts";
  EXPECT_EQ(effort(660), 1.5);
  EXPECT_EQ(gate_.numMisses(), 2) << "the image that was skipped is a miss, too";
}

TEST_F(TorqueGateTest, WhenImagesStopTheTorqueIsZeroAfterTwoSteps) {
  follow();
  EXPECT_EQ(effort(400), 2.0);
  EXPECT_EQ(effort(401), 0.0);
  EXPECT_EQ(gate_.state(), State::kImagesStopped);
  EXPECT_TRUE(gate_.armed());
  showImage(900);
  EXPECT_TRUE(answer(910, 900, 1.0));
  EXPECT_EQ(effort(910), 1.0);
}

TEST_F(TorqueGateTest, WhenTheLastPublisherHasGoneTheTorqueIsZeroUntilTheNextTorque) {
  follow();
  gate_.setPublishers(0);
  EXPECT_EQ(effort(30), 0.0);
  EXPECT_EQ(gate_.state(), State::kNoController);
  gate_.setPublishers(1);
  EXPECT_EQ(effort(40), 0.0) << "a connection alone is no torque";
  showImage(200);
  EXPECT_TRUE(answer(210, 200, 1.0));
  EXPECT_EQ(effort(210), 1.0);
}

TEST_F(TorqueGateTest, NoTorqueActsForLongerThanTheLimitWhateverDtIs) {
  RobotOptions options;
  options.dt = 5.0;
  followWith(options);
  ASSERT_TRUE(answer(20, 0, 2.0));
  EXPECT_EQ(effort(519), 2.0);
  EXPECT_EQ(effort(520), 0.0);
  EXPECT_EQ(gate_.state(), State::kHeldTooLong);
  EXPECT_FALSE(gate_.heldForAStep()) << "nothing is to be learned from a tenth of a step";
  EXPECT_EQ(gate_.numMisses(), 0);
  options.dt = 0.5;
  followWith(options);
  ASSERT_TRUE(answer(20, 0, 2.0));
  EXPECT_EQ(effort(520), 0.0);
  EXPECT_TRUE(gate_.heldForAStep());
}

TEST_F(TorqueGateTest, WithoutASubscriberOfTheEffortsNoTrialBeginsAndNoneGoesOn) {
  gate_.setListeners(0);
  EXPECT_NE(gate_.arm(at(0)).find("effort controller"), std::string::npos);
  gate_.setListeners(1);
  follow();
  gate_.setListeners(0);
  EXPECT_EQ(gate_.state(), State::kStopped);
  EXPECT_EQ(effort(30), 0.0);
  gate_.setListeners(1);
  EXPECT_EQ(effort(40), 0.0) << "until somebody enables the motors";
}

TEST_F(TorqueGateTest, EachImageHasATorqueThatActsOrIsUnanswered) {
  const auto unanswered = [this] {
    std::vector<int> out;
    for (const Stamp stamp : gate_.takeUnanswered()) {
      for (const int ms : {0, 200, 350, 600, 800, 990}) {
        if (stamp == stampOf(ms)) out.push_back(ms);
      }
    }
    return out;
  };
  follow();
  EXPECT_EQ(unanswered(), std::vector<int>());
  showImage(200);
  showImage(350);
  EXPECT_TRUE(answer(360, 350, 9.0));
  EXPECT_EQ(gate_.target(), std::vector<double>{6.0}) << "what the motor can do";
  EXPECT_EQ(unanswered(), std::vector<int>{200}) << "skipped";
  showImage(600);
  EXPECT_FALSE(answer(801, 600, 1.0));
  EXPECT_EQ(unanswered(), std::vector<int>{600}) << "late";
  showImage(800);
  gate_.stop("service enable");
  EXPECT_EQ(unanswered(), std::vector<int>{800}) << "stopped";
  showImage(990);
  EXPECT_FALSE(answer(1000, 990, 1.0));
  effort(1191);
  EXPECT_EQ(unanswered(), std::vector<int>{990}) << "while the motors are off";
  EXPECT_EQ(unanswered(), std::vector<int>());
}

TEST_F(TorqueGateTest, ATorqueForAnImageThatWasNeverShownOrIsAnsweredDoesNotAct) {
  follow();
  EXPECT_FALSE(answer(30, 5, 3.0));
  EXPECT_FALSE(answer(30, 0, 3.0));
  EXPECT_EQ(effort(30), 2.0);
}

TEST_F(TorqueGateTest, BetweenTrialsNothingIsMissed) {
  ASSERT_EQ(gate_.arm(at(0)), "");
  showImage(0);
  EXPECT_EQ(effort(500), 0.0);
  EXPECT_EQ(gate_.state(), State::kWaiting);
  showImage(600);
  EXPECT_TRUE(answer(610, 600, 1.0));
  gate_.endTrial();
  EXPECT_EQ(effort(611), 0.0);
  showImage(800);
  EXPECT_EQ(effort(1100), 0.0);
  EXPECT_EQ(gate_.state(), State::kWaiting);
  EXPECT_EQ(gate_.numMisses(), 0);
}

TEST_F(TorqueGateTest, StopIsZeroAtOnceAndNothingActsUntilArmedAgain) {
  follow();
  gate_.stop("service enable");
  EXPECT_EQ(effort(21), 0.0);
  gate_.endTrial();  // a cancelled episode ends in this way
  EXPECT_FALSE(gate_.armed());
  showImage(200);
  EXPECT_FALSE(answer(210, 200, 3.0));
  ASSERT_EQ(gate_.arm(at(0)), "");
  EXPECT_FALSE(answer(215, 0, 3.0));  // for an image from before the stop
  EXPECT_EQ(effort(220), 0.0);
  showImage(400);
  EXPECT_TRUE(answer(410, 400, 1.0));
}

TEST_F(TorqueGateTest, ATorqueThatIsNotOneFiniteNumberStopsTheMotorsForGood) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& torque :
       std::vector<std::vector<double>>{{nan}, {inf}, {-inf}, {}, {1.0, 2.0}}) {
    gate_ = TorqueGate(RobotOptions());
    follow();
    EXPECT_FALSE(gate_.takeTorque(at(30), stampOf(0), torque));
    EXPECT_EQ(gate_.state(), State::kStopped);
    EXPECT_EQ(effort(30), 0.0);
    showImage(200);
    EXPECT_FALSE(answer(210, 200, 1.0)) << "the next good one must not act";
  }
}

TEST_F(TorqueGateTest, ASecondPublisherStopsTheMotorsAndMustBeGoneBeforeTheyAreArmed) {
  gate_.setPublishers(1);
  follow();
  gate_.setPublishers(2);
  EXPECT_EQ(gate_.state(), State::kStopped);
  EXPECT_EQ(effort(21), 0.0);
  EXPECT_NE(gate_.arm(at(0)).find("2 nodes"), std::string::npos);
  EXPECT_FALSE(gate_.armed());
  gate_.setPublishers(1);
  EXPECT_FALSE(gate_.armed());
  EXPECT_EQ(gate_.arm(at(0)), "");
}

TEST_F(TorqueGateTest, NothingActsDuringAResetArmedBeforeOrMeanwhile) {
  gate_.beginReset();
  gate_.endReset();
  EXPECT_FALSE(gate_.armed()) << "a reset arms nothing";
  follow();
  gate_.beginReset();
  EXPECT_EQ(effort(21), 0.0);
  EXPECT_EQ(gate_.state(), State::kResetting);
  gate_.stop("service enable");
  ASSERT_EQ(gate_.arm(at(0)), "");
  EXPECT_EQ(gate_.state(), State::kResetting);
  showImage(200);
  EXPECT_FALSE(answer(210, 200, 3.0));
  gate_.endReset();
  EXPECT_FALSE(answer(215, 200, 3.0));  // for an image from before the reset
  showImage(400);
  EXPECT_TRUE(answer(410, 400, 1.0));
}

TEST_F(TorqueGateTest, TheTorqueChangesNoFasterThanTheSlewRateButStopsAtOnce) {
  RobotOptions options;
  options.slew_rate = {20.0};
  followWith(options);
  EXPECT_TRUE(answer(10, 0, 2.0));
  EXPECT_NEAR(effort(20), 0.4, 1e-9);  // 20 ms after the previous call, at 0
  EXPECT_NEAR(effort(50), 1.0, 1e-9);
  EXPECT_EQ(effort(150), 2.0);
  showImage(200);
  EXPECT_TRUE(answer(210, 200, -2.0));
  EXPECT_NEAR(effort(250), 0.0, 1e-9);
  EXPECT_NEAR(effort(300), -1.0, 1e-9);
  gate_.stop("service enable");
  EXPECT_EQ(effort(301), 0.0);
}

/// Two motors with limits of 4 and 2 N m.
class TwoMotorTorqueGateTest : public TorqueGateTest {
 protected:
  using Torque = std::vector<double>;

  void SetUp() override { restart({0.0}); }

  /// Arms the gate and shows an image at time 0.
  void restart(const std::vector<double>& slew_rate) {
    RobotOptions options;
    options.max_torque = {4.0, 2.0};
    options.slew_rate = slew_rate;
    followWith(options);
  }
  bool answer(int now, int stamp, const Torque& torque) {
    return gate_.takeTorque(at(now), stampOf(stamp), torque);
  }
  Torque efforts(int now) { return gate_.effort(at(now)); }
};

TEST_F(TwoMotorTorqueGateTest, OneSlewRateHoldsForAllMotorsAndAListForEach) {
  for (const Torque& slew_rate : {Torque{20.0}, Torque{20.0, 20.0}}) {
    restart(slew_rate);
    EXPECT_TRUE(answer(10, 0, {3.0, -0.3}));
    const Torque efforts = gate_.effort(at(20));
    EXPECT_NEAR(efforts.at(0), 0.4, 1e-9);
    EXPECT_NEAR(efforts.at(1), -0.3, 1e-9);
  }
  restart({0.0, 20.0});
  EXPECT_TRUE(answer(10, 0, {3.0, 2.0}));
  EXPECT_EQ(efforts(20).at(0), 3.0);
  EXPECT_NEAR(efforts(20).at(1), 0.4, 1e-9);
}

TEST_F(TwoMotorTorqueGateTest, EveryStopIsZeroForBothMotors) {
  struct Stop {
    std::function<void()> stop;
    int zero_at;  // [ms]
  };
  const std::vector<Stop> stops = {
      {[this] { gate_.stop("service enable"); }, 111},
      {[this] { gate_.endTrial(); }, 111},
      {[this] { gate_.beginReset(); }, 111},
      {[this] { gate_.setPublishers(2); }, 111},
      {[this] { gate_.takeTorque(at(110), stampOf(0), {1.0}); }, 111},  // one number for two motors
      {[] {}, 401},                                                     // no further image
      {[this] { showImage(200); }, 401}};                               // no torque for this image
  for (std::size_t i = 0; i < stops.size(); ++i) {
    restart({20.0});
    EXPECT_TRUE(answer(10, 0, {1.0, -9.0}));
    EXPECT_EQ(gate_.target(), (Torque{1.0, -2.0})) << "each motor has its own limit";
    EXPECT_EQ(efforts(110), (Torque{1.0, -2.0})) << i;
    stops[i].stop();
    EXPECT_EQ(efforts(stops[i].zero_at), (Torque{0.0, 0.0})) << i;
    EXPECT_EQ(gate_.target(), (Torque{0.0, 0.0})) << i;
  }
}

/// A joint with the limits [-2, 1], which is reported at 0.
class GuardedTorqueGateTest : public TorqueGateTest {
 protected:
  void SetUp() override {
    RobotOptions options;
    options.position_limits = {{-2.0, 1.0}};
    gate_ = TorqueGate(options);
    gate_.effort(at(0));
    report(0, 0.0);
  }
  void report(int now, double position) {
    JointReport report;
    report.arrival = at(now);
    report.clock = std::chrono::hours(500000) + std::chrono::milliseconds(now);
    report.stamp = report.clock;
    report.reporter = "/driver";
    report.names = {"arm"};
    report.positions = {position};
    gate_.takeJoints(report);
  }
};

TEST_F(GuardedTorqueGateTest, BeyondALimitTheMotorsStopForGoodAndCannotBeArmedThere) {
  follow();
  report(50, 1.01);
  EXPECT_EQ(gate_.state(), State::kStopped);
  EXPECT_EQ(effort(50), 0.0);
  EXPECT_NE(gate_.describe().find("robot/position_limits"), std::string::npos);
  EXPECT_NE(gate_.arm(at(60)), "");
  EXPECT_FALSE(gate_.armed());
  report(70, 0.9);
  EXPECT_FALSE(gate_.armed()) << "back within its limits, but nobody has looked";
  EXPECT_EQ(gate_.arm(at(80)), "");
}

TEST_F(GuardedTorqueGateTest, WhenTheJointsAreSilentTheTorqueIsZeroUntilTheyAreBack) {
  follow();
  EXPECT_EQ(effort(200), 2.0);
  EXPECT_EQ(effort(201), 0.0);
  EXPECT_EQ(gate_.state(), State::kJointsSilent);
  showImage(210);
  EXPECT_FALSE(answer(220, 210, 3.0));
  EXPECT_EQ(effort(220), 0.0);
  report(230, 0.0);
  showImage(240);
  EXPECT_TRUE(answer(250, 240, 1.0));
  EXPECT_EQ(effort(250), 1.0);
}

TEST_F(GuardedTorqueGateTest, BetweenTrialsJointsMayBeMovedBeyondTheirLimitsButNoTrialBeginsThere) {
  ASSERT_EQ(gate_.arm(at(0)), "");
  report(10, 5.0);
  EXPECT_TRUE(gate_.armed());
  gate_.beginReset();
  report(20, -5.0);
  gate_.endReset();
  EXPECT_TRUE(gate_.armed());
  showImage(30);
  EXPECT_FALSE(answer(40, 30, 1.0));
  EXPECT_EQ(gate_.state(), State::kStopped);
}

}  // namespace
}  // namespace ddm
