// Tests of the joint limits of a robot: violations, and silent joints.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/joint_limits.h"

#include <gtest/gtest.h>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/not_finite.h"

namespace ddm {
namespace {

SteadyTime at(int ms) { return SteadyTime(std::chrono::hours(1) + std::chrono::milliseconds(ms)); }

/// A report that arrives at the time of its measurement; each report has a different stamp.
JointReport reportAt(int ms, const std::string& reporter, const std::vector<std::string>& names,
                     const std::vector<double>& positions, const std::vector<double>& velocities) {
  static int num_reports = 0;
  JointReport out;
  out.arrival = at(ms);
  out.clock = std::chrono::hours(500000) + std::chrono::milliseconds(ms);
  out.stamp = out.clock + Stamp(++num_reports);
  out.reporter = reporter;
  out.names = names;
  out.positions = positions;
  out.velocities = velocities;
  return out;
}

void report(JointLimits* limits, int ms, const std::string& reporter,
            const std::vector<std::string>& names, const std::vector<double>& positions,
            const std::vector<double>& velocities) {
  limits->take(reportAt(ms, reporter, names, positions, velocities));
}

RobotOptions oneJoint() {
  RobotOptions options;
  options.position_limits = {{-2.0, 1.0}};
  options.speed_limit = {8.0};
  return options;
}

RobotOptions twoNamedJoints() {
  RobotOptions options;
  options.joints = {"elbow", "wrist"};
  options.position_limits = {{-2.0, 1.0}, {0.0, kInfinity}};
  return options;
}

TEST(JointLimits, WithoutLimitsNothingIsGuardedAndNothingIsMissing) {
  JointLimits limits{RobotOptions()};
  EXPECT_FALSE(limits.given());
  EXPECT_EQ(limits.silence(at(0)), "");
  EXPECT_EQ(limits.violation(), "");
}

TEST(JointLimits, AJointMustKeepItsPositionAndItsSpeed) {
  JointLimits limits(oneJoint());
  for (const double good : {-2.0, 0.0, 1.0}) {
    report(&limits, 0, "/driver", {}, {good}, {8.0});
    EXPECT_EQ(limits.violation(), "") << good;
  }
  for (const double bad : {-2.001, 1.001, kNaN, kInfinity}) {
    report(&limits, 0, "/driver", {"arm"}, {bad}, {0.0});
    EXPECT_TRUE(testing::names(limits.violation(), {"robot/position_limits allows -2 to 1"}))
        << bad;
  }
  for (const double bad : {8.001, -8.001, kNaN, -kInfinity}) {
    report(&limits, 0, "/driver", {}, {0.0}, {bad});
    EXPECT_TRUE(testing::names(limits.violation(), {"robot/speed_limit allows 8"})) << bad;
  }
  report(&limits, 0, "/driver", {}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation(), "") << "it is judged by its last report";
}

TEST(JointLimits, WhatALimitNeedsMustBeReported) {
  JointLimits limits(oneJoint());
  report(&limits, 0, "/driver", {"arm"}, {0.0}, {});
  EXPECT_TRUE(testing::names(limits.violation(), {"no velocity"}));
  report(&limits, 0, "/driver", {"arm"}, {}, {0.0});
  EXPECT_TRUE(testing::names(limits.violation(), {"no position"}));
  RobotOptions speed_only = oneJoint();
  speed_only.position_limits.clear();
  JointLimits speed(speed_only);
  report(&speed, 0, "/driver", {"arm"}, {}, {0.0});
  EXPECT_EQ(speed.violation(), "");
}

TEST(JointLimits, WithoutNamesTheNumberOfJointsMustFit) {
  JointLimits limits(oneJoint());
  report(&limits, 0, "/driver", {"a", "b"}, {0.0, 0.0}, {0.0, 0.0});
  EXPECT_TRUE(testing::names(limits.violation(), {"robot/joints"}));
  EXPECT_NE(limits.silence(at(0)), "");
  report(&limits, 10, "/driver", {"a"}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation() + limits.silence(at(10)), "");
}

TEST(JointLimits, JointsAreFoundByNameInAnyOrderAndInSeveralMessages) {
  JointLimits limits(twoNamedJoints());
  report(&limits, 0, "/driver", {"gripper", "wrist", "elbow"}, {99.0, 5.0, 0.5}, {});
  EXPECT_EQ(limits.violation(), "");
  report(&limits, 0, "/driver", {"gripper"}, {99.0}, {});
  EXPECT_EQ(limits.violation(), "");
  report(&limits, 0, "/driver", {"wrist"}, {-0.1}, {});
  report(&limits, 0, "/driver", {"elbow"}, {0.5}, {});
  EXPECT_TRUE(testing::names(limits.violation(), {"joint wrist", "-0.1", "robot/position_limits"}));
}

TEST(JointLimits, EachJointThatIsNotReportedForAWhileIsSilent) {
  JointLimits limits(twoNamedJoints());
  EXPECT_TRUE(testing::names(limits.silence(at(0)), {"elbow"}));
  report(&limits, 0, "/driver", {"elbow", "wrist"}, {0.5, 5.0}, {});
  EXPECT_EQ(limits.silence(at(200)), "");
  report(&limits, 200, "/driver", {"elbow"}, {0.5}, {});
  EXPECT_TRUE(testing::names(limits.silence(at(201)), {"wrist"}));
}

TEST(JointLimits, AJointThatTwoNodesReportIsAViolationUntilOneOfThemIsSilent) {
  JointLimits limits(oneJoint());
  report(&limits, 0, "/driver", {"arm"}, {0.0}, {0.0});
  report(&limits, 10, "/display", {"arm"}, {0.0}, {0.0});
  EXPECT_TRUE(testing::names(limits.violation(), {"by /driver and by /display"}))
      << limits.violation();
  report(&limits, 20, "/driver", {"arm"}, {0.0}, {0.0});
  report(&limits, 1020, "/driver", {"arm"}, {0.0}, {0.0});
  EXPECT_TRUE(testing::names(limits.violation(), {"only its driver"}))
      << "a slow one may report again";
  report(&limits, 1021, "/driver", {"arm"}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation(), "");
  report(&limits, 2022, "/driver_started_again", {"arm"}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation(), "") << "it took over from one that is gone";
}

TEST(JointLimits, AReportCountsFromWhenTheJointsWereMeasured) {
  const auto silenceOf = [](Stamp age) {
    JointLimits limits(oneJoint());
    JointReport report = reportAt(0, "/driver", {"arm"}, {0.0}, {0.0});
    report.stamp -= age;
    limits.take(report);
    return limits.silence(at(0));
  };
  EXPECT_EQ(silenceOf(std::chrono::milliseconds(100)), "");
  for (const Stamp age : {Stamp(std::chrono::seconds(2)), Stamp(-std::chrono::seconds(2))}) {
    EXPECT_TRUE(testing::names(silenceOf(age), {"joint_states driver", "differ by 2 s", "0.2 s"}));
  }
  JointLimits limits(oneJoint());
  JointReport report = reportAt(0, "/driver", {"arm"}, {0.0}, {0.0});
  report.stamp = Stamp(0);
  limits.take(report);
  EXPECT_TRUE(testing::names(limits.silence(at(0)), {"no stamp", "header.stamp"}));
}

TEST(JointLimits, AReportThatRepeatsAnEarlierOneLeavesTheJointSilentUntilTheNextNewOne) {
  JointLimits limits(oneJoint());
  const JointReport first = reportAt(0, "/driver", {"arm"}, {0.0}, {0.0});
  limits.take(first);
  for (int ms = 10; ms <= 300; ms += 10) {
    JointReport again = first;
    again.arrival = at(ms);
    again.clock += std::chrono::milliseconds(ms);
    limits.take(again);
  }
  EXPECT_NE(limits.silence(at(450)), "") << "the measurement is 0.45 s old";
  report(&limits, 460, "/driver", {"arm"}, {0.0}, {0.0});
  EXPECT_EQ(limits.silence(at(460)), "");
}

TEST(JointLimits, APositionThatStaysWhileTorquesChangeIsFrozenUntilItMoves) {
  JointLimits limits(oneJoint());
  report(&limits, 0, "/driver", {"arm"}, {0.5}, {0.0});
  for (int i = 0; i < JointLimits::kFrozenTorques; ++i) {
    EXPECT_EQ(limits.frozen(), "");
    limits.torqueChanges();
    report(&limits, 10, "/driver", {"arm"}, {0.5}, {0.0});
  }
  EXPECT_TRUE(testing::names(limits.frozen(), {"number 0", "exactly 0.5", "10 torques"}));
  EXPECT_EQ(limits.violation(), "");
  report(&limits, 20, "/driver", {"arm"}, {0.5001}, {0.0});
  EXPECT_EQ(limits.frozen(), "");
}

}  // namespace
}  // namespace ddm
