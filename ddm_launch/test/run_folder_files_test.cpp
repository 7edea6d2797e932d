// Tests of the files of a run folder: each is written as a whole, and no bag is overwritten.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <boost/filesystem.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "run_folder.h"
#include "run_folder_case.h"
#include "tables.h"
#include "toy_run.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::textOf;
using testing::throwsNaming;
using testing::toyRow;
using testing::writeText;

using RunFolderFilesTest = testing::RunFolderCase;

TEST_F(RunFolderFilesTest, BagsOfAnEarlierTryAreKeptUnderOtherNames) {
  finish(1);
  RunFolder folder(configuration_);
  for (const std::string attempt : {"first", "second"}) {
    std::vector<std::string> kept;
    const std::string bag = folder.beginRun({1}, &kept);
    EXPECT_FALSE(fs::exists(bag) || fs::exists(bag + ".active"));
    EXPECT_EQ(kept.size(), attempt == "first" ? 0u : 2u);
    writeText(bag, attempt);
    writeText(bag + ".active", attempt + " active");
  }
  folder.beginRun({1});
  EXPECT_EQ(textOf(file("trial_001/trial.1.bag")), "first");
  EXPECT_EQ(textOf(file("trial_001/trial.1.bag.active")), "first active");
  EXPECT_EQ(textOf(file("trial_001/trial.2.bag")), "second");
  EXPECT_EQ(textOf(file("trial_001/trial.2.bag.active")), "second active");
  EXPECT_EQ(textOf(file("trial_000/trial.bag")), "a bag");
}

TEST_F(RunFolderFilesTest, AFolderThatCannotBeMadeOrWrittenIsNamed) {
  writeText(scratch_.file("plain_file"), "");
  // Not even root can create files below /proc.
  for (const std::string& path : {scratch_.file("plain_file"), scratch_.file("plain_file/run"),
                                  std::string("/proc/ddm"), std::string("/proc/self")}) {
    configuration_.experiment.runs = path;
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { RunFolder(configuration_).beginRun({0}); },
                                                 {"cannot", path}));
  }
}

TEST_F(RunFolderFilesTest, DistancesInFeaturesAreWrittenWhereTheTrueStateIsNotKnown) {
  RunFolder folder(configuration_);
  TrialOutcome outcome;
  outcome.torques = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1)};
  outcome.exploratory = {false, false};
  outcome.goal_distances = {1.5, 0.1};
  folder.writeRun({0, /*evaluation=*/true}, outcome);
  EXPECT_EQ(textOf(file("evaluation_000/goal_distance.csv")), "step,goal_distance\n0,1.5\n1,0.1\n");
  outcome.states = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  outcome.times = {0.0, 0.2};
  folder.writeRun({1, /*evaluation=*/true}, outcome);
  EXPECT_FALSE(fs::exists(file("evaluation_001/goal_distance.csv")));
}

TEST_F(RunFolderFilesTest, TorquesOfARobotAreThoseOfItsMotorsWhateverThePlantIs) {
  configuration_.robot = RobotOptions();
  TrialOutcome outcome;
  outcome.exploratory = {true};
  const auto written = [&](const std::string& name) {
    configuration_.experiment.runs = file(name);
    RunFolder(configuration_).writeRun({0, /*evaluation=*/false}, outcome);
    return textOf(file(name + "/trial_000/torques.csv"));
  };
  outcome.torques = {Eigen::Vector2d(0.1, -2.0)};
  configuration_.robot->max_torque = {6.0, 4.0};
  EXPECT_EQ(written("two_motors"),
            "step,torque_1_nm,torque_2_nm,exploratory\n0,0.10000000000000001,-2,1\n");
  outcome.torques = {Eigen::VectorXd::Constant(1, 0.5)};
  configuration_.robot->max_torque = {6.0};
  testing::usePlant(testing::plantOf("{type: moving_tile}"), &configuration_);
  EXPECT_EQ(written("one_motor"), "step,torque_nm,exploratory\n0,0.5,1\n");
}

TEST_F(RunFolderFilesTest, ATrainingIsReadBackDigitByDigitUnlessItIsDamaged) {
  TrainingOutcome training;
  training.frames = 30;
  training.v_r = 1.0 / 3.0;
  training.v_p = 1e-7;
  training.seconds = 0.1;
  training.evaluations = 26;
  RunFolder folder(configuration_);
  EXPECT_FALSE(folder.savedTraining(0));
  folder.writeTraining(0, training);
  const TrainingOutcome saved = folder.savedTraining(0).value();
  EXPECT_EQ(saved.frames, 30u);
  EXPECT_EQ(saved.v_r, training.v_r);
  EXPECT_EQ(saved.v_p, training.v_p);
  EXPECT_EQ(saved.seconds, 0.1);
  EXPECT_EQ(saved.evaluations, 26u);
  writeText(file("trial_000/training.yaml"), "frames: 30\n");
  EXPECT_FALSE(folder.savedTraining(0));
}

TEST_F(RunFolderFilesTest, NumbersThatNoReaderTakesAreNotWritten) {
  RunFolder folder(configuration_);
  TrialOutcome outcome;
  outcome.torques = {Eigen::VectorXd::Constant(1, std::nan(""))};
  outcome.exploratory = {false};
  EXPECT_TRUE(throwsNaming<std::range_error>([&] { folder.writeRun({0}, outcome); }, {"nan"}));
  EXPECT_FALSE(fs::exists(file("trial_000/torques.csv")));
  TrialRow row = toyRow(0);
  row.v_p = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(throwsNaming<std::range_error>([&] { folder.finishTrial(row); }, {"inf"}));
  EXPECT_FALSE(fs::exists(file("trials.csv")));
}

TEST_F(RunFolderFilesTest, AVerdictIsOneThatSaysSoAndIsRemovedBeforeTheNextTrial) {
  finish(1);
  for (const std::string text : {"", "[", "7\n", "[1]\n", "finished: false\n", "finished: [1]\n"}) {
    writeText(file("summary.yaml"), text);
    EXPECT_FALSE(RunFolder(configuration_).confirmSummary()) << text;
  }
  {
    RunFolder folder(configuration_);
    folder.writeSummary(1.0);
    EXPECT_TRUE(folder.confirmSummary());
  }
  RunFolder folder(configuration_);
  folder.beginRun({1});
  EXPECT_FALSE(folder.confirmSummary());
}

TEST_F(RunFolderFilesTest, TheSummaryHoldsTheVerdict) {
  RunFolder folder(configuration_);
  for (int trial = 0; trial < 3; ++trial) folder.finishTrial(toyRow(trial));
  folder.writeSummary(2.5);
  const YAML::Node summary = YAML::LoadFile(file("summary.yaml"));
  EXPECT_TRUE(summary["finished"].as<bool>());
  EXPECT_EQ(summary["trials"].as<int>(), 2);
  EXPECT_EQ(summary["seed"].as<int>(), 7);
  EXPECT_EQ(summary["success"].as<std::vector<int>>(), (std::vector<int>{0, 1, 0}));
  EXPECT_DOUBLE_EQ(summary["mean_success"].as<double>(), 1.0 / 3.0);
  EXPECT_EQ(summary["wall_s"].as<double>(), 2.5);
  TrialRow row = toyRow(3);
  row.evaluation = Evaluation();
  folder.finishTrial(row);
  folder.writeSummary(1.0);
  const YAML::Node unknown = YAML::LoadFile(file("summary.yaml"));
  EXPECT_TRUE(unknown["finished"].as<bool>());
  EXPECT_FALSE(unknown["success"].IsDefined() || unknown["mean_success"].IsDefined());
}

TEST_F(RunFolderFilesTest, RowsThatAreNotThoseOfTheExperimentAreRefused) {
  finish(2);
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0), toyRow(2)}));
  expectRefused({"trials.csv", "row 2", "trial 1"});
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0, /*seed=*/9)}));
  expectRefused({"trials.csv", "row 1", "seed 7"});
  writeText(file("trials.csv"), "nonsense\n");
  expectRefused({"trials.csv", "line 1"});
}

TEST_F(RunFolderFilesTest, RowsOfWhichAnyByteHasChangedAreRefused) {
  finish(2);
  const std::string rows = textOf(file("trials.csv"));
  for (size_t at = 0; at < rows.size(); ++at) {
    std::string changed = rows;
    changed[at] = static_cast<char>(changed[at] ^ 1);  // changes a digit or another character
    writeText(file("trials.csv"), changed);
    expectRefused({"trials.csv"});
  }
  writeText(file("trials.csv"), rows);
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
}

TEST_F(RunFolderFilesTest, AnExperimentThatEndedBetweenTheChecksumAndItsRowIsTakenUp) {
  finish(2);
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0)}));
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
}

TEST_F(RunFolderFilesTest, RowsThatTheChecksumsDoNotKnowAreRefused) {
  finish(2);
  writeText(file(".trials.crc32"), "");
  expectRefused({"trials.csv", ".trials.crc32", "remove"});
}

TEST_F(RunFolderFilesTest, RowsWithoutChecksumsAreTakenWithAWarning) {
  finish(2);
  fs::remove(file(".trials.crc32"));
  {
    RunFolder folder(configuration_);
    ASSERT_EQ(folder.warnings().size(), 1u);
    EXPECT_NE(folder.warnings()[0].find(".trials.crc32"), std::string::npos);
    writeText(folder.beginRun({2}), "a bag");
    folder.finishTrial(toyRow(2));
  }
  EXPECT_TRUE(RunFolder(configuration_).warnings().empty());
}

TEST_F(RunFolderFilesTest, RowsWithoutAConfigurationAreRefused) {
  finish(1);
  fs::remove(file("config.yaml"));
  expectRefused({"trials.csv", "no config.yaml"});
}

}  // namespace
}  // namespace ddm
