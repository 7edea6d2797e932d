// Tests of the MPC state: what it remembers, and in which order.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/history.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace ddm {
namespace {

Eigen::VectorXd scalar(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(History, TheFirstFeatureStandsForThoseBeforeItAtRest) {
  History x(3, 2, 1);
  EXPECT_TRUE(x.empty());
  x.observe(Eigen::Vector2d(1.0, 2.0));
  EXPECT_FALSE(x.empty());
  Eigen::MatrixXd expected(2, 3);
  expected << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0;
  EXPECT_EQ(x.features(), expected);
  EXPECT_EQ(x.torques(), Eigen::MatrixXd::Zero(1, 2));
}

TEST(History, KeepsTheNewestFirstAndForgetsTheOldest) {
  History x(3, 1, 1);
  for (int t = 0; t < 5; ++t) {
    x.observe(scalar(t));
    if (t < 4) x.apply(scalar(10 + t));
  }
  EXPECT_EQ(x.features(), Eigen::RowVector3d(4.0, 3.0, 2.0));  // z_t, z_{t-1}, z_{t-2}
  EXPECT_EQ(x.torques(), Eigen::RowVector2d(13.0, 12.0));      // u_{t-1}, u_{t-2}
}

TEST(History, RefusesSizesBelowOne) {
  EXPECT_THROW(History(0, 1, 1), std::invalid_argument);
  EXPECT_THROW(History(1, 0, 1), std::invalid_argument);
  EXPECT_THROW(History(1, 1, -3), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
