// Tests of trials.csv: what is written is read back, what is damaged is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "trials_csv.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <boost/algorithm/string.hpp>

#include "toy_run.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using testing::toyRow;

std::string header() { return formatTrialsCsv({}); }

/// The row of trial 0 with another text in one of its columns, counted from 0.
std::string withColumn(size_t index, const std::string& value) {
  const std::string text = formatTrialsCsv({toyRow(0)});
  std::string row = text.substr(header().size(), text.size() - header().size() - 1);
  std::vector<std::string> columns;
  boost::split(columns, row, boost::is_any_of(","));
  columns[index] = value;
  return header() + boost::join(columns, ",") + "\n";
}

TEST(TrialsCsv, HasTheColumnsOfTheContract) {
  EXPECT_EQ(header(),
            "seed,trial,frames,success,success_strict,final_error,v_r,v_p,train_s,"
            "train_evaluations,plan_ms_median,plan_ms_p99,version,return\n");
}

TEST(TrialsCsv, RowsAreReadBackAsTheyWere) {
  std::vector<TrialRow> rows = {toyRow(0), toyRow(1), toyRow(2)};
  rows[1].evaluation.total_reward = -1.0 / 3.0;
  const std::vector<TrialRow> read = parseTrialsCsv(formatTrialsCsv(rows), "trials.csv");
  ASSERT_EQ(read.size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(read[i].seed, rows[i].seed);
    EXPECT_EQ(read[i].trial, rows[i].trial);
    EXPECT_EQ(read[i].frames, rows[i].frames);
    EXPECT_EQ(read[i].evaluation.known, rows[i].evaluation.known);
    EXPECT_EQ(read[i].evaluation.success, rows[i].evaluation.success);
    EXPECT_EQ(read[i].evaluation.success_strict, rows[i].evaluation.success_strict);
    EXPECT_EQ(read[i].evaluation.final_error, rows[i].evaluation.final_error);
    EXPECT_EQ(read[i].evaluation.total_reward, rows[i].evaluation.total_reward);
    EXPECT_EQ(read[i].v_r, rows[i].v_r);
    EXPECT_EQ(read[i].v_p, rows[i].v_p);
    EXPECT_EQ(read[i].train_s, rows[i].train_s);
    EXPECT_EQ(read[i].train_evaluations, rows[i].train_evaluations);
    EXPECT_EQ(read[i].plan_ms_median, rows[i].plan_ms_median);
    EXPECT_EQ(read[i].plan_ms_p99, rows[i].plan_ms_p99);
    EXPECT_EQ(read[i].version, rows[i].version);
  }
}

TEST(TrialsCsv, AFileThatIsReadAndWrittenStaysTheSame) {
  const std::string text = formatTrialsCsv({toyRow(0), toyRow(1)});
  EXPECT_EQ(formatTrialsCsv(parseTrialsCsv(text, "trials.csv")), text);
}

TEST(TrialsCsv, AReturnIsTheLastColumn) {
  TrialRow row = toyRow(1);
  row.evaluation.total_reward = -12.5;
  const std::string text = formatTrialsCsv({row});
  EXPECT_EQ(text.substr(text.size() - 7), ",-12.5\n");
  EXPECT_EQ(parseTrialsCsv(text, "trials.csv")[0].evaluation.total_reward, -12.5);
  row.evaluation.total_reward.reset();
  EXPECT_EQ(formatTrialsCsv({row}).substr(formatTrialsCsv({row}).rfind(',')), ",\n");
}

TEST(TrialsCsv, SuccessIsEmptyWhereItIsNotKnown) {
  TrialRow row = toyRow(0);
  row.evaluation = Evaluation();
  const std::string text = formatTrialsCsv({row});
  EXPECT_NE(text.find("7,0,30,,,,0.333"), std::string::npos) << text;
  EXPECT_FALSE(parseTrialsCsv(text, "trials.csv")[0].evaluation.known);
  EXPECT_EQ(formatTrialsCsv(parseTrialsCsv(text, "trials.csv")), text);
}

TEST(TrialsCsv, SuccessWithoutGroundTruthHasNoError) {
  TrialRow row = toyRow(1);
  row.evaluation.final_error = std::nullopt;
  const std::string text = formatTrialsCsv({row});
  EXPECT_NE(text.find("7,1,60,1,0,,0.333"), std::string::npos) << text;
  const TrialRow read = parseTrialsCsv(text, "trials.csv")[0];
  EXPECT_TRUE(read.evaluation.known && read.evaluation.success);
  EXPECT_FALSE(read.evaluation.final_error.has_value());
}

TEST(TrialsCsv, ErrorsThatAMethodDoesNotHaveAreEmpty) {
  TrialRow row = toyRow(0);
  row.v_r = std::nullopt;
  row.v_p = std::nullopt;
  const std::string text = formatTrialsCsv({row});
  EXPECT_NE(text.find(",,,0.125,26,"), std::string::npos) << text;
  const TrialRow read = parseTrialsCsv(text, "trials.csv")[0];
  EXPECT_FALSE(read.v_r.has_value());
  EXPECT_FALSE(read.v_p.has_value());
  EXPECT_EQ(read.train_s, row.train_s);
}

TEST(TrialsCsv, AnotherHeaderIsRefused) {
  for (const std::string text : {"", "seed,trial\n", "\n", "7,0,30,1,1,0.1,1,1,1,26,1,1,?\n"}) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { parseTrialsCsv(text, "DIR/trials.csv"); },
                                                 {"DIR/trials.csv, line 1", "seed,trial,frames"}))
        << text;
  }
}

TEST(TrialsCsv, ADamagedValueIsRefusedWithItsLine) {
  const std::vector<std::pair<size_t, std::string>> faults = {
      {0, "x"},   {0, ""},      {1, "1.5"}, {2, "-1"},    {2, ""},    {3, "2"},
      {3, "yes"}, {3, ""},      {4, ""},    {5, "far"},   {6, "nan"}, {6, ""},
      {7, "inf"}, {8, "1s"},    {8, "-1"},  {8, "1e13"},  {9, "2.5"}, {10, "0.2 ms"},
      {11, ""},   {11, "-inf"}, {12, ""},   {13, "much"}, {13, "nan"}};
  for (const auto& fault : faults) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>(
        [&] { parseTrialsCsv(withColumn(fault.first, fault.second), "DIR/trials.csv"); },
        {"DIR/trials.csv, line 2"}))
        << "column " << fault.first << ": '" << fault.second << "'";
  }
}

TEST(TrialsCsv, AnErrorOrReturnOfARunThatIsNotKnownIsRefused) {
  TrialRow row = toyRow(0);
  row.evaluation = Evaluation();
  const std::string text = formatTrialsCsv({row});
  const std::string with_return = text.substr(0, text.size() - 1) + "-1.0\n";
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { parseTrialsCsv(with_return, "trials.csv"); },
                                               {"trials.csv, line 2", "return"}));
  std::string with_error = text;
  with_error.insert(with_error.find(",,,,") + 3, "0.5");
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { parseTrialsCsv(with_error, "trials.csv"); },
                                               {"trials.csv, line 2", "final_error"}));
}

TEST(TrialsCsv, ALineOfAnotherLengthIsRefusedWithItsNumber) {
  const std::string good = formatTrialsCsv({toyRow(0)});
  for (const std::string line : {"7,1,60\n", "\n", "7,1,60,1,1,0.1,1,1,1,26,1,1,1,1,1\n"}) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { parseTrialsCsv(good + line, "trials.csv"); },
                                                 {"trials.csv, line 3", "14"}))
        << line;
  }
}

TEST(TrialsCsv, AFileThatIsCutShortIsRefused) {
  const std::string text = formatTrialsCsv({toyRow(0), toyRow(1)});
  const std::string cut = text.substr(0, text.find("0.25", text.rfind("7,1,")));
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { parseTrialsCsv(cut, "trials.csv"); },
                                               {"trials.csv, line 3"}));
  EXPECT_TRUE(throwsNaming<std::runtime_error>(
      [&] { parseTrialsCsv(text.substr(0, text.size() - 1), "trials.csv"); },
      {"trials.csv, line 3", "no end"}));
}

}  // namespace
}  // namespace ddm
