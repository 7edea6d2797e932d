// Tests of the run folder: it resumes its own experiment, refuses any other, and loses nothing.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_folder.h"

#include <ddm_model/model_file.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "toy_run.h"
#include "trials_csv.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::fingerprintOf;
using testing::textOf;
using testing::throwsNaming;
using testing::toyConfiguration;
using testing::toyRow;
using testing::withoutVersions;
using testing::writeText;

class RunFolderTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return scratch_.file("run/" + name); }

  /// Makes the folder and finishes this many trials in it.
  void finish(int num_trials) {
    RunFolder folder(configuration_);
    for (int trial = 0; trial < num_trials; ++trial) {
      writeText(folder.beginRun({trial}), "a bag");
      folder.finishTrial(toyRow(trial));
    }
  }

  /// Begins the first trial, which is not finished.
  void begin() { RunFolder(configuration_).beginRun({0}); }

  void expectRefused(const std::vector<std::string>& words) {
    EXPECT_TRUE(
        throwsNaming<std::runtime_error>([this] { RunFolder folder(configuration_); }, words));
  }

  testing::TempFolder scratch_;
  Configuration configuration_ = toyConfiguration(scratch_.file("run"));
};

TEST_F(RunFolderTest, ANewFolderIsMadeWithTheEffectiveConfigurationAndTheVersion) {
  configuration_.experiment.runs = file("with/parents");
  RunFolder folder(configuration_);
  folder.beginRun({0});
  const YAML::Node saved = YAML::LoadFile(file("with/parents/config.yaml"));
  EXPECT_EQ(saved["version"].as<std::string>(), codeVersion());
  EXPECT_EQ(saved["experiment"]["seed"].as<int>(), 7);
  EXPECT_EQ(saved["model"]["pca_dim"].as<int>(), 10);
  EXPECT_EQ(saved["plant"]["dt"].as<double>(), 0.2);
  EXPECT_EQ(saved.size(), 12u) << "the version and eleven blocks";
  EXPECT_TRUE(folder.rows().empty());
  EXPECT_TRUE(folder.warnings().empty());
}

TEST_F(RunFolderTest, TheSameExperimentTakesUpWhereItWas) {
  finish(2);
  const RunFolder folder(configuration_);
  ASSERT_EQ(folder.rows().size(), 2u);
  EXPECT_EQ(folder.rows()[1].frames, 60u);
  EXPECT_TRUE(folder.warnings().empty());
}

TEST_F(RunFolderTest, AFolderIsOnlyMadeForTheFirstResult) {
  { const RunFolder folder(configuration_); }
  EXPECT_FALSE(fs::exists(scratch_.file("run")));
  RunFolder folder(configuration_);
  EXPECT_FALSE(fs::exists(scratch_.file("run")));
  folder.beginRun({0});
  EXPECT_TRUE(fs::exists(file("config.yaml")));
}

TEST_F(RunFolderTest, OpeningAFolderChangesNothingInIt) {
  finish(2);
  RunFolder(configuration_).writeSummary(1.0);
  const auto before = fingerprintOf(scratch_.file("run"));
  configuration_.experiment.trials = 5;
  const RunFolder folder(configuration_);
  EXPECT_TRUE(folder.isFinished());
  EXPECT_EQ(fingerprintOf(scratch_.file("run")), before);
}

TEST_F(RunFolderTest, TrialsMayGrow) {
  finish(2);
  configuration_.experiment.trials = 5;
  RunFolder folder(configuration_);
  EXPECT_EQ(folder.rows().size(), 2u);
  folder.beginRun({2});
  EXPECT_EQ(YAML::LoadFile(file("config.yaml"))["experiment"]["trials"].as<int>(), 5);
}

TEST_F(RunFolderTest, TimeLimitsMayDiffer) {
  finish(1);
  configuration_.experiment.timeout = 10.0;
  configuration_.sim.watchdog = 10.0;
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
}

TEST_F(RunFolderTest, AFolderThatWasMovedIsStillTheSameExperiment) {
  finish(1);
  fs::rename(scratch_.file("run"), scratch_.file("moved"));
  configuration_.experiment.runs = scratch_.file("moved");
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
}

TEST_F(RunFolderTest, AnotherSeedPlantOrPresetIsRefusedWithBothValues) {
  finish(1);
  configuration_.experiment.seed = 8;
  configuration_.experiment.plant = "pendulum_gravity";
  configuration_.experiment.preset = "debug";
  expectRefused({"experiment/seed: 7 there, 8 here",
                 "experiment/plant: pendulum there, pendulum_gravity here",
                 "experiment/preset: paper there, debug here", "another folder"});
}

TEST_F(RunFolderTest, AnotherValueOfAnyOtherKeyIsRefused) {
  finish(1);
  const Configuration there = configuration_;
  const std::vector<std::pair<std::string, std::function<void(Configuration*)>>> changes = {
      {"trial/num_steps: 30 there, 31 here", [](auto* c) { c->trial.num_steps = 31; }},
      {"evaluation/settled_steps: 10", [](auto* c) { c->evaluation.settled_steps = 11; }},
      {"plant/friction: 1.0 there, 0.5 here",
       [](auto* c) { c->plant = testing::plantOf("{type: pendulum, friction: 0.5}"); }},
      {"plant/edge_softness",
       [](auto* c) { c->plant = testing::plantOf("{type: pendulum, edge_softness: 0.3}"); }},
      {"camera/noise_std", [](auto* c) { c->camera.noise_std = 0.3; }},
      {"evaluation/tolerance: 10.0 there, 9.0 here",
       [](auto* c) { c->evaluation.tolerance = 9.0; }},
      {"sim/lockstep", [](auto* c) { c->sim.lockstep = false; }},
      {"image/size", [](auto* c) { c->model.image.size = 50; }},
      {"model/encoder_widths",
       [](auto* c) {
         c->model.model.encoder_widths = {25, 12};
       }},
      {"training/max_iterations", [](auto* c) { c->model.training.max_iterations = 1; }},
      {"data_set/torque_topic", [](auto* c) { c->model.data_set.torque_topic = "u"; }},
      {"mpc/epsilon: 0.2 there, 0.20000000000000004 here",
       [](auto* c) { c->mpc.epsilon = std::nextafter(0.2, 1.0); }}};
  for (const auto& change : changes) {
    configuration_ = there;
    change.second(&configuration_);
    expectRefused({change.first});
  }
}

/// As the plant of a model file with this digest.
class DigestPlugin : public testing::ToyPlugin {
 public:
  explicit DigestPlugin(std::string digest)
      : ToyPlugin(testing::ToyPlant::Traits()), digest_(std::move(digest)) {}
  YAML::Node block() const override {
    YAML::Node out = ToyPlugin::block();
    out["model_digest"] = digest_;
    return out;
  }

 private:
  std::string digest_;
};

TEST_F(RunFolderTest, AChangedModelFileIsRefused) {
  configuration_.plant = std::make_shared<DigestPlugin>("crc32-00000001");
  finish(1);
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
  configuration_.plant = std::make_shared<DigestPlugin>("crc32-00000002");
  expectRefused(
      {"plant/model_digest: crc32-00000001 there, crc32-00000002 here", "model file", "changed"});
}

TEST_F(RunFolderTest, CropAndGoalOfARobotMayChangeUntilATrialIsFinished) {
  const std::vector<std::pair<std::string, std::function<void(Configuration*)>>> changes = {
      {"robot/crop_x: 0 there, 8 here", [](auto* c) { c->robot->crop_x = 8; }},
      {"robot/crop_height: 0 there, 80 here", [](auto* c) { c->robot->crop_height = 80; }},
      {"robot/goal_file", [](auto* c) { c->robot->goal_file = "/goal.png"; }},
      {"evaluation/goal_distance: 0.0 there, 0.4 here",
       [](auto* c) { c->evaluation.goal_distance = 0.4; }}};
  configuration_.robot = RobotOptions();
  const Configuration there = configuration_;
  begin();
  for (const auto& change : changes) change.second(&configuration_);
  begin();
  EXPECT_EQ(YAML::LoadFile(file("config.yaml"))["robot"]["crop_x"].as<int>(), 8);
  configuration_ = there;
  finish(1);
  for (const auto& change : changes) {
    configuration_ = there;
    change.second(&configuration_);
    expectRefused({change.first, "another folder", "first trial"});
  }
}

TEST_F(RunFolderTest, NothingElseMayChangeBeforeATrialIsFinished) {
  configuration_.robot = RobotOptions();
  const Configuration there = configuration_;
  begin();
  configuration_.robot->dt = 0.3;
  expectRefused({"robot/dt"});
  configuration_ = there;
  configuration_.experiment.seed = 8;
  expectRefused({"experiment/seed"});
  configuration_ = there;
  configuration_.robot.reset();
  configuration_.evaluation.goal_distance = 0.4;
  expectRefused({"evaluation/goal_distance"});
}

TEST_F(RunFolderTest, ARefusedFolderKeepsItsConfigurationAndRows) {
  finish(1);
  const std::string config = textOf(file("config.yaml"));
  const std::string rows = textOf(file("trials.csv"));
  configuration_.experiment.seed = 8;
  expectRefused({"experiment/seed"});
  EXPECT_EQ(textOf(file("config.yaml")), config);
  EXPECT_EQ(textOf(file("trials.csv")), rows);
}

TEST_F(RunFolderTest, ARefusedFolderCanBeUsedAtOnceByItsOwnExperiment) {
  finish(1);
  configuration_.experiment.seed = 8;
  expectRefused({"experiment/seed"});
  configuration_.experiment.seed = 7;
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
}

TEST_F(RunFolderTest, AnotherVersionOfTheCodeWarns) {
  finish(1);
  std::string config = textOf(file("config.yaml"));
  config.replace(0, config.find('\n'), "version: 0.0.1 (abc)");
  writeText(file("config.yaml"), config);
  const RunFolder folder(configuration_);
  ASSERT_EQ(folder.warnings().size(), 1u);
  EXPECT_NE(folder.warnings()[0].find("0.0.1 (abc)"), std::string::npos);
  EXPECT_NE(folder.warnings()[0].find(codeVersion()), std::string::npos);
}

TEST_F(RunFolderTest, TheVersionThatBeganStaysInTheConfiguration) {
  finish(1);
  std::string config = textOf(file("config.yaml"));
  config.replace(0, config.find('\n'), "version: 0.0.1 (abc)");
  writeText(file("config.yaml"), config);
  RunFolder folder(configuration_);
  folder.beginRun({1});
  EXPECT_EQ(textOf(file("config.yaml")), config);
}

TEST_F(RunFolderTest, ASecondExperimentInTheSameFolderIsRefused) {
  RunFolder first(configuration_);
  first.beginRun({0});
  const auto before = fingerprintOf(scratch_.file("run"));
  expectRefused({scratch_.file("run"), "is running"});
  EXPECT_EQ(fingerprintOf(scratch_.file("run")), before);
}

TEST_F(RunFolderTest, OfTwoExperimentsInOneNewFolderTheFirstThatWritesHasIt) {
  RunFolder first(configuration_);
  RunFolder second(configuration_);
  first.beginRun({0});
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { second.beginRun({0}); },
                                               {scratch_.file("run"), "another experiment"}));
  auto third = std::make_unique<RunFolder>(toyConfiguration(scratch_.file("new")));
  RunFolder fourth(toyConfiguration(scratch_.file("new")));
  third->beginRun({0});
  third.reset();  // the lock is free again
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { fourth.beginRun({0}); },
                                               {scratch_.file("new"), "was begun", "meanwhile"}));
}

TEST_F(RunFolderTest, AFolderIsFreeAfterItsExperiment) {
  finish(1);
  EXPECT_NO_THROW(RunFolder second(configuration_));
}

TEST_F(RunFolderTest, AFinishedTrialWithoutItsBagIsRefused) {
  finish(2);
  fs::remove(file("trial_001/trial.bag"));
  expectRefused({"trial_001/trial.bag", "missing"});
}

TEST_F(RunFolderTest, BagsOfAnEarlierTryAreKeptUnderOtherNames) {
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

TEST_F(RunFolderTest, RowsThatAreNotThoseOfTheExperimentAreRefused) {
  finish(2);
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0), toyRow(2)}));
  expectRefused({"trials.csv", "row 2", "trial 1"});
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0, /*seed=*/9)}));
  expectRefused({"trials.csv", "row 1", "seed 7"});
  writeText(file("trials.csv"), "nonsense\n");
  expectRefused({"trials.csv", "line 1"});
}

TEST_F(RunFolderTest, RowsOfWhichAnyByteHasChangedAreRefused) {
  finish(2);
  const std::string rows = textOf(file("trials.csv"));
  for (size_t at = 0; at < rows.size(); ++at) {
    std::string changed = rows;
    changed[at] = static_cast<char>(changed[at] ^ 1);  // another digit, where there is one
    writeText(file("trials.csv"), changed);
    expectRefused({"trials.csv"});
  }
  writeText(file("trials.csv"), rows);
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
}

/// @param rows  texts of trials.csv with 1, 2, ... rows
std::string checksumsOf(const std::vector<std::string>& rows) {
  std::string lines;
  for (const std::string& text : rows) lines += checksum(text) + "\n";
  return lines;
}

TEST_F(RunFolderTest, ATableOfAnOlderVersionGoesOnInTodaysColumns) {
  for (const auto& older : {testing::inDegrees, withoutVersions}) {
    fs::remove_all(scratch_.file("run"));
    finish(2);
    const std::vector<std::string> old = {older(formatTrialsCsv({toyRow(0)})),
                                          older(textOf(file("trials.csv")))};
    writeText(file("trials.csv"), old[1]);
    writeText(file(".trials.crc32"), checksumsOf(old));
    const std::string version = older == withoutVersions ? "?" : toyRow(1).version;
    {
      RunFolder folder(configuration_);
      ASSERT_EQ(folder.rows().size(), 2u);
      EXPECT_EQ(folder.rows()[1].version, version);
      EXPECT_EQ(folder.rows()[1].evaluation.final_error, toyRow(1).evaluation.final_error);
      EXPECT_TRUE(folder.warnings().empty());
      writeText(folder.beginRun({2}), "a bag");
      folder.finishTrial(toyRow(2));
    }
    const RunFolder folder(configuration_);
    EXPECT_EQ(folder.rows()[0].version, version);
    EXPECT_EQ(folder.rows()[2].version, toyRow(2).version);
  }
}

/// config.yaml as versions saved it whose cameras drew the rod and whose errors were angles.
YAML::Node asSavedBefore(const YAML::Node& today) {
  YAML::Node old = YAML::Clone(today);
  old["camera"]["size"] = old["plant"]["picture_size"];
  old["plant"].remove("picture_size");
  for (const char* key : {"half_extent", "rod_half_width", "edge_softness"}) {
    old["camera"][key] = old["plant"][key];
    old["plant"].remove(key);
  }
  old["plant"]["tile_width"] = 9.0;
  old["plant"]["tile_softness"] = 9.0;
  old["evaluation"]["tolerance_deg"] = old["evaluation"]["tolerance"];
  old["evaluation"].remove("tolerance");
  old["evaluation"].remove("error_unit");
  old["training"]["ensemble_size"] = "1";
  old["mpc"]["terminal_weight"] = "1.0";
  return old;
}

TEST_F(RunFolderTest, AFolderOfAnOlderVersionIsTakenUp) {
  finish(2);
  const YAML::Node today = YAML::LoadFile(file("config.yaml"));
  const YAML::Node old = asSavedBefore(today);
  writeText(file("config.yaml"), YAML::Dump(old) + "\n");
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
  configuration_.camera.noise_std = 0.3;
  expectRefused({"camera/noise_std"});
}

TEST_F(RunFolderTest, AFolderOfAnOlderVersionThatEndedBetweenTheChecksumAndItsRowIsTakenUp) {
  finish(2);
  writeText(file("trials.csv"), withoutVersions(textOf(file("trials.csv"))));
  TrialRow rows[] = {toyRow(0), toyRow(1), toyRow(2)};
  for (int i : {0, 1}) rows[i].version = "?";
  writeText(file(".trials.crc32"), formatTrialsChecksums({rows[0], rows[1], rows[2]}));
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
}

TEST_F(RunFolderTest, AnExperimentThatEndedBetweenTheChecksumAndItsRowIsTakenUp) {
  finish(2);
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0)}));
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
}

TEST_F(RunFolderTest, RowsThatTheChecksumsDoNotKnowAreRefused) {
  finish(2);
  writeText(file(".trials.crc32"), "");
  expectRefused({"trials.csv", ".trials.crc32", "remove"});
}

TEST_F(RunFolderTest, RowsWithoutChecksumsAreTakenWithAWarning) {
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

TEST_F(RunFolderTest, AConfigurationThatCannotBeReadIsRefused) {
  finish(1);
  writeText(file("config.yaml"), "experiment: [\n");
  expectRefused({"config.yaml", "read"});
  for (const std::string text : {"7", "[1, 2]", "{[1]: {a: 2}}", "trial: {[1]: 2}", "a: &x [*x]"}) {
    writeText(file("config.yaml"), text);
    expectRefused({"config.yaml", "read", "another folder"});
  }
}

TEST_F(RunFolderTest, RowsWithoutAConfigurationAreRefused) {
  finish(1);
  fs::remove(file("config.yaml"));
  expectRefused({"trials.csv", "no config.yaml"});
}

TEST_F(RunFolderTest, NoFolderIsRefused) {
  configuration_.experiment.runs = "";
  expectRefused({"no folder"});
}

TEST_F(RunFolderTest, AFolderThatCannotBeMadeOrWrittenIsNamed) {
  writeText(scratch_.file("plain_file"), "");
  // Below /proc nobody makes files, not even root.
  for (const std::string& path : {scratch_.file("plain_file"), scratch_.file("plain_file/run"),
                                  std::string("/proc/ddm"), std::string("/proc/self")}) {
    configuration_.experiment.runs = path;
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { RunFolder(configuration_).beginRun({0}); },
                                                 {"cannot", path}));
  }
}

TEST_F(RunFolderTest, FilesAreReplacedAsAWhole) {
  RunFolder folder(configuration_);
  folder.finishTrial(toyRow(0));
  std::ifstream reader(file("trials.csv"));  // begins to read before the next row is written
  folder.finishTrial(toyRow(1));
  std::ostringstream seen;
  seen << reader.rdbuf();
  EXPECT_EQ(seen.str(), formatTrialsCsv({toyRow(0)}));
  EXPECT_EQ(textOf(file("trials.csv")), formatTrialsCsv({toyRow(0), toyRow(1)}));
}

TEST_F(RunFolderTest, NothingButTheFilesOfTheContractIsLeft) {
  {
    RunFolder folder(configuration_);
    testing::ObedientDriver driver;
    driver.state = Eigen::Vector2d::Zero();
    TrialRequest request;
    request.num_steps = 2;
    const TrialOutcome outcome = driver.runTrial(request, [](double) {});
    folder.writeRun({0, /*evaluation=*/false}, outcome);
    TrainingOutcome training;
    training.files["model.ddm"] = "model";
    folder.writeTraining(0, training);
    folder.writeRun({0, /*evaluation=*/true}, outcome);
    folder.finishTrial(toyRow(0));
    folder.writeSummary(1.0);
  }
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(scratch_.file("run"))) {
    if (fs::is_regular_file(entry)) {
      names.push_back(fs::relative(entry.path(), scratch_.file("run")).string());
    }
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{
                       ".trials.crc32", "config.yaml", "evaluation_000/torques.csv",
                       "evaluation_000/trajectory.csv", "summary.yaml", "trial_000/model.ddm",
                       "trial_000/torques.csv", "trial_000/trajectory.csv", "trials.csv"}));
}

TEST_F(RunFolderTest, DistancesInFeaturesAreWrittenWhereTheTrueStateIsNotKnown) {
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

TEST_F(RunFolderTest, TorquesAreWrittenWith17Digits) {
  RunFolder folder(configuration_);
  TrialOutcome outcome;
  outcome.torques = {Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Constant(1, -6.0)};
  outcome.exploratory = {true, false};
  folder.writeRun({3, /*evaluation=*/false}, outcome);
  EXPECT_EQ(textOf(file("trial_003/torques.csv")),
            "step,torque_nm,exploratory\n0,0.10000000000000001,1\n1,-6,0\n");
}

TEST_F(RunFolderTest, TheVerdictOfAnEarlierCallIsRemovedBeforeTheNextTrial) {
  {
    RunFolder folder(configuration_);
    folder.finishTrial(toyRow(0));
    writeText(folder.beginRun({0}), "a bag");
    folder.writeSummary(1.0);
  }
  RunFolder folder(configuration_);
  ASSERT_TRUE(folder.isFinished());
  folder.beginRun({1});
  EXPECT_FALSE(fs::exists(file("summary.yaml")));
  EXPECT_FALSE(folder.isFinished());
}

TEST_F(RunFolderTest, ASummaryThatMakesNoSenseIsNoVerdict) {
  finish(1);
  for (const std::string text : {"", "[", "7\n", "[1]\n", "finished: false\n", "finished: [1]\n"}) {
    writeText(file("summary.yaml"), text);
    EXPECT_FALSE(RunFolder(configuration_).isFinished()) << text;
  }
}

TEST_F(RunFolderTest, TheSummaryHoldsTheVerdict) {
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
}

TEST_F(RunFolderTest, TheSummaryClaimsNoSuccessThatIsNotKnown) {
  RunFolder folder(configuration_);
  TrialRow row = toyRow(0);
  row.evaluation = Evaluation();
  folder.finishTrial(row);
  folder.writeSummary(1.0);
  const YAML::Node summary = YAML::LoadFile(file("summary.yaml"));
  EXPECT_TRUE(summary["finished"].as<bool>());
  EXPECT_FALSE(summary["success"].IsDefined());
  EXPECT_FALSE(summary["mean_success"].IsDefined());
}

}  // namespace
}  // namespace ddm
