// Tests of the limits of a robot's joints: what violates them, and which joints are silent.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/joint_limits.h"

#include <gtest/gtest.h>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/not_finite.h"

namespace ddm {
namespace {

SteadyTime at(int ms) { return SteadyTime(std::chrono::hours(1) + std::chrono::milliseconds(ms)); }

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
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
    limits.take(at(0), "/driver", {}, {good}, {8.0});
    EXPECT_EQ(limits.violation(), "") << good;
  }
  for (const double bad : {-2.001, 1.001, kNaN, kInfinity}) {
    limits.take(at(0), "/driver", {"arm"}, {bad}, {0.0});
    EXPECT_TRUE(contains(limits.violation(), "robot/position_limits allows -2 to 1")) << bad;
  }
  for (const double bad : {8.001, -8.001, kNaN, -kInfinity}) {
    limits.take(at(0), "/driver", {}, {0.0}, {bad});
    EXPECT_TRUE(contains(limits.violation(), "robot/speed_limit allows 8")) << bad;
  }
  limits.take(at(0), "/driver", {}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation(), "") << "it is judged by its last report";
}

TEST(JointLimits, WhatALimitNeedsMustBeReported) {
  JointLimits limits(oneJoint());
  limits.take(at(0), "/driver", {"arm"}, {0.0}, {});
  EXPECT_TRUE(contains(limits.violation(), "no velocity"));
  limits.take(at(0), "/driver", {"arm"}, {}, {0.0});
  EXPECT_TRUE(contains(limits.violation(), "no position"));
  RobotOptions speed_only = oneJoint();
  speed_only.position_limits.clear();
  JointLimits speed(speed_only);
  speed.take(at(0), "/driver", {"arm"}, {}, {0.0});
  EXPECT_EQ(speed.violation(), "");
}

TEST(JointLimits, WithoutNamesTheNumberOfJointsMustFit) {
  JointLimits limits(oneJoint());
  limits.take(at(0), "/driver", {"a", "b"}, {0.0, 0.0}, {0.0, 0.0});
  EXPECT_TRUE(contains(limits.violation(), "robot/joints"));
  EXPECT_NE(limits.silence(at(0)), "");
  limits.take(at(10), "/driver", {"a"}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation() + limits.silence(at(10)), "");
}

TEST(JointLimits, JointsAreFoundByNameInAnyOrderAndInSeveralMessages) {
  JointLimits limits(twoNamedJoints());
  limits.take(at(0), "/driver", {"gripper", "wrist", "elbow"}, {99.0, 5.0, 0.5}, {});
  EXPECT_EQ(limits.violation(), "");
  limits.take(at(0), "/driver", {"gripper"}, {99.0}, {});
  EXPECT_EQ(limits.violation(), "");
  limits.take(at(0), "/driver", {"wrist"}, {-0.1}, {});
  limits.take(at(0), "/driver", {"elbow"}, {0.5}, {});
  EXPECT_TRUE(testing::names(limits.violation(), {"joint wrist", "-0.1", "robot/position_limits"}));
}

TEST(JointLimits, EachJointThatIsNotReportedForAWhileIsSilent) {
  JointLimits limits(twoNamedJoints());
  EXPECT_TRUE(contains(limits.silence(at(0)), "elbow"));
  limits.take(at(0), "/driver", {"elbow", "wrist"}, {0.5, 5.0}, {});
  EXPECT_EQ(limits.silence(at(200)), "");
  limits.take(at(200), "/driver", {"elbow"}, {0.5}, {});
  EXPECT_TRUE(contains(limits.silence(at(201)), "wrist"));
}

TEST(JointLimits, AJointThatTwoNodesReportIsAViolationUntilOneOfThemIsSilent) {
  JointLimits limits(oneJoint());
  limits.take(at(0), "/driver", {"arm"}, {0.0}, {0.0});
  limits.take(at(10), "/display", {"arm"}, {0.0}, {0.0});
  EXPECT_TRUE(contains(limits.violation(), "by /driver and by /display")) << limits.violation();
  limits.take(at(20), "/driver", {"arm"}, {0.0}, {0.0});
  limits.take(at(1020), "/driver", {"arm"}, {0.0}, {0.0});
  EXPECT_TRUE(contains(limits.violation(), "only its driver")) << "a slow one may report again";
  limits.take(at(1021), "/driver", {"arm"}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation(), "");
  limits.take(at(2022), "/driver_started_again", {"arm"}, {0.0}, {0.0});
  EXPECT_EQ(limits.violation(), "") << "it took over from one that is gone";
}

TEST(JointLimits, SeveralNodesMayReportOtherJoints) {
  JointLimits limits(twoNamedJoints());
  for (int ms = 0; ms < 100; ms += 10) {
    limits.take(at(ms), "/arm", {"elbow"}, {0.5}, {});
    limits.take(at(ms), "/hand", {"wrist"}, {0.5}, {});
    EXPECT_EQ(limits.violation(), "");
  }
}

}  // namespace
}  // namespace ddm
