// Tests of trajectory.csv: states are read back digit by digit, what is damaged is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_csv.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <utility>

namespace ddm {
namespace {

using testing::throwsNaming;

const std::vector<std::string> kNames = {"angle_rad", "rate_rad_per_s"};

std::string example() {
  std::vector<Eigen::VectorXd> states(2, Eigen::VectorXd::Zero(2));
  states[0] << 1.0 / 3.0, -1e-17;
  states[1] << 9.0, 2.0;
  return formatTrajectoryCsv({0.0, 0.2}, states, kNames);
}

TEST(TrajectoryCsv, StatesAreReadBackDigitByDigit) {
  EXPECT_EQ(example().substr(0, example().find('\n')), "step,time_s,angle_rad,rate_rad_per_s");
  const Eigen::MatrixXd states = parseTrajectoryCsv(example(), kNames, "trajectory.csv");
  ASSERT_EQ(states.rows(), 2);
  ASSERT_EQ(states.cols(), 2);
  EXPECT_EQ(states(0, 0), 1.0 / 3.0);
  EXPECT_EQ(states(1, 0), -1e-17);
  EXPECT_EQ(states(0, 1), 9.0);
  EXPECT_EQ(states(1, 1), 2.0);
}

TEST(TrajectoryCsv, WhatIsDamagedIsRefusedWithItsLine) {
  const std::string header = example().substr(0, example().find('\n') + 1);
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"", "line 1: must be step,time_s,angle_rad"},
      {"step,time_s,x_px,y_px\n", "line 1"},
      {header + "0,0,1\n", "line 2: has 3 columns, 4 are due"},
      {header + "1,0,1,2\n", "line 2: must be step 0, got 1"},
      {header + "0,0,1,2\n0,0.2,1,2\n", "line 3: must be step 1"},
      {header + "0,0,1,nan\n", "line 2: 'nan' is not finite"},
      {header + "0,soon,1,2\n", "line 2: 'soon' is no number"},
      {header + "0,0,1,far\n", "line 2: 'far' is no number"},
      {header + "0,0,1,2\n1,0.2,1,2", "line 3: has no end: the file is cut short"}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>(
        [&] { parseTrajectoryCsv(fault.first, kNames, "DIR/trajectory.csv"); },
        {"DIR/trajectory.csv, " + fault.second}))
        << fault.first;
  }
}

}  // namespace
}  // namespace ddm
