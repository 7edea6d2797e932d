// Tests of the tables: written tables are read back unchanged, and damaged tables are refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "tables.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <boost/algorithm/string.hpp>
#include <utility>

#include "toy_run.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using testing::toyRow;

std::string header() { return formatTrialsCsv({}); }

/// The row of trial 0 with another text in one of its columns.
/// @param index  column, counted from 0
std::string withColumn(size_t index, const std::string& value) {
  const std::string text = formatTrialsCsv({toyRow(0)});
  std::string row = text.substr(header().size(), text.size() - header().size() - 1);
  std::vector<std::string> columns;
  boost::split(columns, row, boost::is_any_of(","));
  columns[index] = value;
  return header() + boost::join(columns, ",") + "\n";
}

TEST(TrialsCsv, RowsAreReadBackAsTheyWereAndWhatIsNotKnownStaysEmpty) {
  std::vector<TrialRow> rows = {toyRow(0), toyRow(1), toyRow(2), toyRow(3)};
  rows[0].evaluation.total_reward = -1.0 / 3.0;
  rows[1].evaluation = Evaluation();
  rows[2].evaluation.final_error.reset();
  rows[3].v_r = rows[3].v_p = std::nullopt;
  const std::string text = formatTrialsCsv(rows);
  for (const std::string part :
       {"7,0,30,0,0,0.1,0.3333333333333333,1.0e-07,0.125,26,0.250,1.500,1.2.3 (abcdef0),-0.3333",
        "\n7,1,60,,,,0.333", "\n7,2,90,0,0,,0.333", "\n7,3,120,1,0,0.4,,,0.125,"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
  }
  const std::vector<TrialRow> read = parseTrialsCsv(text, "trials.csv");
  EXPECT_EQ(formatTrialsCsv(read), text);
  ASSERT_EQ(read.size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(read[i].evaluation.known, rows[i].evaluation.known);
    EXPECT_EQ(read[i].evaluation.success, rows[i].evaluation.success);
    EXPECT_EQ(read[i].evaluation.final_error, rows[i].evaluation.final_error);
    EXPECT_EQ(read[i].evaluation.total_reward, rows[i].evaluation.total_reward);
    EXPECT_EQ(read[i].v_r, rows[i].v_r);
    EXPECT_EQ(read[i].plan_ms_p99, rows[i].plan_ms_p99);
  }
}

TEST(TrialsCsv, ALineThatIsCutShortOrOfAnotherLengthIsRefusedWithItsNumber) {
  const std::string good = formatTrialsCsv({toyRow(0)});
  const std::string whole = formatTrialsCsv({toyRow(0), toyRow(1)});
  for (const std::string& text :
       {good + "7,1,60\n", good + "\n", good + "7,1,60,1,1,0.1,1,1,1,26,1,1,1,1,1\n",
        whole.substr(0, whole.size() - 9), whole.substr(0, whole.size() - 1)}) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { parseTrialsCsv(text, "trials.csv"); },
                                                 {"trials.csv, line 3"}))
        << text;
  }
}

TEST(TrialsCsv, ADamagedValueIsRefusedWithItsLine) {
  const std::vector<std::pair<size_t, std::string>> faults = {
      {0, "x"},       {0, ""},    {1, "1.5"},   {2, ""},      {3, "2"},   {3, "yes"},
      {4, ""},        {5, "far"}, {6, "nan"},   {7, "inf"},   {8, "1s"},  {9, "2.5"},
      {10, "0.2 ms"}, {11, ""},   {11, "-inf"}, {13, "much"}, {13, "nan"}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>(
        [&] { parseTrialsCsv(withColumn(fault.first, fault.second), "DIR/trials.csv"); },
        {"DIR/trials.csv, line 2"}))
        << "column " << fault.first << ": '" << fault.second << "'";
  }
}

TEST(TorquesCsv, RowsThatDoNotFitTheHeaderAreNotWritten) {
  const std::vector<Eigen::VectorXd> torques = {Eigen::Vector2d(1.0, 2.0),
                                                Eigen::VectorXd::Zero(1)};
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] {
        formatTorquesCsv(torques, {false, false}, {"dx_px", "dy_px"});
      },
      {"step 1 has 1 ", " 2 (dx_px,dy_px)"}));
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
      {header + "0,0,1\n", {line + "2: ", "3 columns", " 4 "}},
      {header + "0,0,1,2\n0,0.2,1,2\n", {line + "3: ", "step 1", "got 0"}},
      {header + "0,0,1,nan\n", {line + "2: ", "'nan'", "finite"}},
      {header + "0,soon,1,2\n", {line + "2: ", "'soon'", "number"}},
      {header + "0,0,1,2\n1,0.2,1,2", {line + "3: ", "no end"}}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>(
        [&] { parseTrajectoryCsv(fault.first, kStateNames, "DIR/trajectory.csv"); }, fault.second))
        << fault.first;
  }
}

}  // namespace
}  // namespace ddm
