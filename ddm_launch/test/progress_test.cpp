// Tests of the progress on the terminal: its text, and that files contain no escape codes.
// SPDX-License-Identifier: BSD-3-Clause
#include "progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "toy_run.h"

namespace ddm {
namespace {

using testing::toyRow;

class ProgressTest : public ::testing::Test {
 protected:
  /// The text of an experiment with two trials, of which the second is a success, and of its
  /// summary.
  std::string textOf(bool live) {
    std::ostringstream out;
    Progress progress(&out, live, /*num_trials=*/1, "px");
    progress.note("warning: mind the step");
    for (int trial = 0; trial < 2; ++trial) {
      progress.beginPhase(trial, "train");
      progress.update(0.5);
      rows_.push_back(toyRow(trial));
      progress.finishTrial(rows_);
    }
    progress.summary(rows_, "/DIR", 12.34);
    return out.str();
  }

  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  std::vector<TrialRow> rows_;
};

TEST_F(ProgressTest, AFileHoldsLinesOnly) {
  const std::string text = textOf(/*live=*/false);
  EXPECT_EQ(std::count_if(text.begin(), text.end(),
                          [](unsigned char c) { return c != '\n' && (c < ' ' || c > '~'); }),
            0)
      << text;
  EXPECT_FALSE(has(text, "train  ")) << text;
}

TEST_F(ProgressTest, EachFinishedTrialIsOneLineAndATerminalAlsoShowsABar) {
  const std::string file = textOf(/*live=*/false);
  for (const std::string part : {"trial  0/1", "trial  1/1", "30 frames", "0.1 px", "success",
                                 "2 models", "60 frames", "1 of 2", "12.3 s", "/DIR/trials.csv"}) {
    EXPECT_TRUE(has(file, part)) << part << " is not in\n" << file;
  }
  rows_.clear();
  const std::string terminal = textOf(/*live=*/true);
  for (const std::string part : {"trial  1/1", "train", "[....", "0 %", "success 0 of 1"}) {
    EXPECT_TRUE(has(terminal, part)) << part << " is not in\n" << terminal;
  }
}

TEST_F(ProgressTest, WithoutGroundTruthSuccessInFeaturesIsToldWithoutAnError) {
  for (const bool success : {true, false}) {
    std::ostringstream out;
    Progress progress(&out, /*live=*/false, /*num_trials=*/0, "px");
    TrialRow row = toyRow(0);
    row.evaluation = Evaluation();
    row.evaluation.known = true;
    row.evaluation.success = success;
    progress.finishTrial({row});
    EXPECT_TRUE(has(out.str(), success ? "  success\n" : "  no success\n")) << out.str();
    EXPECT_FALSE(has(out.str(), "px")) << out.str();
  }
}

TEST_F(ProgressTest, WithoutGroundTruthNoSuccessIsClaimed) {
  std::ostringstream out;
  Progress progress(&out, /*live=*/false, /*num_trials=*/0);
  TrialRow row = toyRow(0);
  row.evaluation = Evaluation();
  progress.finishTrial({row});
  progress.summary({row}, "/DIR", 1.0);
  EXPECT_TRUE(has(out.str(), "ground truth")) << out.str();
  EXPECT_FALSE(has(out.str(), "success")) << out.str();
  EXPECT_FALSE(has(out.str(), "reached")) << out.str();
}

}  // namespace
}  // namespace ddm
