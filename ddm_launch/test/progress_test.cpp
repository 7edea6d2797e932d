// Tests of the progress on the terminal: its text, and that files contain no escape codes.
// SPDX-License-Identifier: BSD-3-Clause
#include "progress.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "toy_run.h"

namespace ddm {
namespace {

using testing::names;
using testing::toyRow;

/// The text of an experiment with two trials, of which the second is a success, and of its summary.
std::string outputOf(bool live) {
  std::ostringstream out;
  std::vector<TrialRow> rows;
  Progress progress(&out, live, /*num_trials=*/1, "px");
  progress.note("warning: mind the step");
  for (int trial = 0; trial < 2; ++trial) {
    progress.beginPhase(trial, "train");
    progress.update(0.5);
    rows.push_back(toyRow(trial));
    progress.finishTrial(rows);
  }
  progress.summary(rows, "/DIR", 12.34);
  return out.str();
}

TEST(Progress, AFileHoldsALineForEachTrialAndATerminalAlsoShowsABar) {
  const std::string file = outputOf(/*live=*/false);
  EXPECT_EQ(std::count_if(file.begin(), file.end(),
                          [](unsigned char c) { return c != '\n' && (c < ' ' || c > '~'); }),
            0)
      << file;
  EXPECT_FALSE(names(file, {"train  "})) << file;
  EXPECT_TRUE(names(file, {"trial  0/1", "trial  1/1", "30 frames", "0.1 px", "success", "2 models",
                           "60 frames", "1 of 2", "12.3 s", "/DIR/trials.csv"}));
  EXPECT_TRUE(
      names(outputOf(/*live=*/true), {"trial  1/1", "train", "[....", "0 %", "success 0 of 1"}));
}

TEST(Progress, WithoutGroundTruthSuccessIsThatInFeaturesOrNotClaimed) {
  struct Case {
    bool known, success;
    std::string verdict;
  };
  for (const Case& c : {Case{true, true, "  success\n"}, Case{true, false, "  no success\n"},
                        Case{false, false, "  no ground truth\n"}}) {
    std::ostringstream out;
    Progress progress(&out, /*live=*/false, /*num_trials=*/0, "px");
    TrialRow row = toyRow(0);
    row.evaluation = Evaluation();
    row.evaluation.known = c.known;
    row.evaluation.success = c.success;
    progress.finishTrial({row});
    progress.summary({row}, "/DIR", 1.0);
    EXPECT_TRUE(names(out.str(), {c.verdict}));
    EXPECT_FALSE(names(out.str(), {"px"})) << out.str();
    for (const std::string word : {"reached", "success"}) {
      EXPECT_EQ(static_cast<bool>(names(out.str(), {word})), c.known) << out.str();
    }
  }
}

}  // namespace
}  // namespace ddm
