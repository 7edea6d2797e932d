// Tests of torques.csv: torques are read back digit by digit, what is damaged is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "torques_csv.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <utility>

namespace ddm {
namespace {

const std::vector<std::string> kNames = {"dx_px", "dy_px"};

TEST(TorquesCsv, TorquesAreReadBackDigitByDigit) {
  TorqueRows rows;
  rows.torques = {Eigen::Vector2d(1.0 / 3.0, -2.0), Eigen::Vector2d(0.0, 1e-300)};
  rows.exploratory = {true, false};
  const std::string text = formatTorquesCsv(rows, kNames);
  EXPECT_EQ(text.substr(0, text.find('\n')), "step,dx_px,dy_px,exploratory");
  const TorqueRows read = parseTorquesCsv(text, kNames, "torques.csv");
  EXPECT_EQ(read.torques, rows.torques);
  EXPECT_EQ(read.exploratory, rows.exploratory);
}

TEST(TorquesCsv, WhatIsDamagedIsRefusedWithItsLine) {
  const std::string header = formatTorquesCsv({}, kNames);
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"", "line 1: must be step,dx_px,dy_px,exploratory"},
      {header + "0,1,0\n", "line 2: has 3 columns, 4 are due"},
      {header + "0,1,2,0\n2,1,2,0\n", "line 3: must be step 1, got 2"},
      {header + "0,1,inf,0\n", "line 2: 'inf' is not finite"},
      {header + "0,1,2,yes\n", "line 2: 'yes' must be 0 or 1"},
      {header + "0,1,2,0", "line 2: has no end"}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(testing::throwsNaming<std::runtime_error>(
        [&] { parseTorquesCsv(fault.first, kNames, "torques.csv"); },
        {"torques.csv, " + fault.second}))
        << fault.first;
  }
}

}  // namespace
}  // namespace ddm
