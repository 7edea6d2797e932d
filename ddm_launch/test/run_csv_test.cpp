// Tests of torques.csv and trajectory.csv: what is written is read back, what is damaged is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_csv.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <utility>

namespace ddm {
namespace {

using testing::throwsNaming;

const std::vector<std::string> kTorqueNames = {"dx_px", "dy_px"};

TEST(TorquesCsv, TorquesAreReadBackDigitByDigit) {
  TorqueRows rows;
  rows.torques = {Eigen::Vector2d(1.0 / 3.0, -2.0), Eigen::Vector2d(0.0, 1e-300)};
  rows.exploratory = {true, false};
  const std::string text = formatTorquesCsv(rows, kTorqueNames);
  EXPECT_EQ(text.substr(0, text.find('\n')), "step,dx_px,dy_px,exploratory");
  const TorqueRows read = parseTorquesCsv(text, kTorqueNames, "torques.csv");
  EXPECT_EQ(read.torques, rows.torques);
  EXPECT_EQ(read.exploratory, rows.exploratory);
}

TEST(TorquesCsv, RowsThatDoNotFitTheHeaderAreNotWritten) {
  TorqueRows rows;
  rows.torques = {Eigen::Vector2d(1.0, 2.0), Eigen::VectorXd::Zero(1)};
  rows.exploratory = {false, false};
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { formatTorquesCsv(rows, kTorqueNames); },
                                                  {"step 1 has 1 ", " 2 (dx_px,dy_px)"}));
}

TEST(TorquesCsv, WhatIsDamagedIsRefusedWithItsLine) {
  const std::string header = formatTorquesCsv({}, kTorqueNames);
  const std::string line = "torques.csv, line ";
  const std::vector<std::pair<std::string, std::vector<std::string>>> faults = {
      {"", {line + "1: ", "step,dx_px,dy_px,exploratory"}},
      {header + "0,1,0\n", {line + "2: ", "3 columns", " 4 "}},
      {header + "0,1,2,0\n2,1,2,0\n", {line + "3: ", "step 1", "got 2"}},
      {header + "0,1,inf,0\n", {line + "2: ", "'inf'", "finite"}},
      {header + "0,1,2,yes\n", {line + "2: ", "'yes'", "0 or 1"}},
      {header + "0,1,2,0", {line + "2: ", "no end"}}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>(
        [&] { parseTorquesCsv(fault.first, kTorqueNames, "torques.csv"); }, fault.second))
        << fault.first;
  }
}

const std::vector<std::string> kStateNames = {"angle_rad", "rate_rad_per_s"};

std::string example() {
  std::vector<Eigen::VectorXd> states(2, Eigen::VectorXd::Zero(2));
  states[0] << 1.0 / 3.0, -1e-17;
  states[1] << 9.0, 2.0;
  return formatTrajectoryCsv({0.0, 0.2}, states, kStateNames);
}

TEST(TrajectoryCsv, StatesAreReadBackDigitByDigit) {
  EXPECT_EQ(example().substr(0, example().find('\n')), "step,time_s,angle_rad,rate_rad_per_s");
  const Eigen::MatrixXd states = parseTrajectoryCsv(example(), kStateNames, "trajectory.csv");
  ASSERT_EQ(states.rows(), 2);
  ASSERT_EQ(states.cols(), 2);
  EXPECT_EQ(states(0, 0), 1.0 / 3.0);
  EXPECT_EQ(states(1, 0), -1e-17);
  EXPECT_EQ(states(0, 1), 9.0);
  EXPECT_EQ(states(1, 1), 2.0);
}

TEST(TrajectoryCsv, WhatIsDamagedIsRefusedWithItsLine) {
  const std::string header = example().substr(0, example().find('\n') + 1);
  const std::string line = "DIR/trajectory.csv, line ";
  const std::vector<std::pair<std::string, std::vector<std::string>>> faults = {
      {"", {line + "1: ", "step,time_s,angle_rad"}},
      {"step,time_s,x_px,y_px\n", {line + "1: ", "step,time_s,angle_rad"}},
      {header + "0,0,1\n", {line + "2: ", "3 columns", " 4 "}},
      {header + "1,0,1,2\n", {line + "2: ", "step 0", "got 1"}},
      {header + "0,0,1,2\n0,0.2,1,2\n", {line + "3: ", "step 1", "got 0"}},
      {header + "0,0,1,nan\n", {line + "2: ", "'nan'", "finite"}},
      {header + "0,soon,1,2\n", {line + "2: ", "'soon'", "number"}},
      {header + "0,0,1,far\n", {line + "2: ", "'far'", "number"}},
      {header + "0,0,1,2\n1,0.2,1,2", {line + "3: ", "no end"}}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>(
        [&] { parseTrajectoryCsv(fault.first, kStateNames, "DIR/trajectory.csv"); }, fault.second))
        << fault.first;
  }
}

}  // namespace
}  // namespace ddm
