// Tests of limits of motors: one for all, or one for each.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/per_motor.h"

#include <gtest/gtest.h>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

TEST(PerMotor, OneNumberHoldsForAllMotors) {
  EXPECT_EQ(perMotor({2.0}, 3, "limit"), Eigen::Vector3d(2.0, 2.0, 2.0));
  EXPECT_EQ(perMotor({4.0, 2.0}, 2, "limit"), Eigen::Vector2d(4.0, 2.0));
}

TEST(PerMotor, AnotherNumberIsRefusedWithTheKey) {
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [] {
        perMotor({4.0, 2.0}, 3, "mpc/max_torque");
      },
      {"mpc/max_torque", "3", "[4, 2]"}));
  EXPECT_THROW(perMotor({}, 1, "mpc/max_torque"), std::invalid_argument);
}

TEST(PerMotor, LimitsAreComparedMotorByMotor) {
  EXPECT_TRUE(within({2.0}, {2.0}));
  EXPECT_TRUE(within({2.0}, {2.0, 3.0}));
  EXPECT_TRUE(within({3.0, 2.0}, {3.0}));
  EXPECT_TRUE(within({4.0, 2.0}, {4.0, 2.0}));
  EXPECT_FALSE(within({2.1}, {2.0, 3.0}));
  EXPECT_FALSE(within({3.1, 2.0}, {3.0}));
  EXPECT_FALSE(within({2.0, 4.0}, {4.0, 2.0}));
  EXPECT_FALSE(within({1.0, 1.0}, {4.0, 2.0, 3.0}));
}

}  // namespace
}  // namespace ddm
