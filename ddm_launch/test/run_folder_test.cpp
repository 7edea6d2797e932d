// Tests of which experiments a run folder resumes and which it refuses.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_folder.h"

#include <gtest/gtest.h>

#include <boost/filesystem.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "run_folder_case.h"
#include "toy_run.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::fingerprintOf;
using testing::textOf;
using testing::throwsNaming;
using testing::toyConfiguration;
using testing::writeText;

class RunFolderTest : public testing::RunFolderCase {
 protected:
  /// Begins the first trial without finishing it.
  void begin() { RunFolder(configuration_).beginRun({0}); }
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
  EXPECT_EQ(saved["goal"]["error_unit"].as<std::string>(), "deg");
  EXPECT_EQ(saved["goal"]["tolerance"].as<double>(), 10.0);
  EXPECT_TRUE(folder.rows().empty());
  EXPECT_TRUE(folder.warnings().empty());
}

TEST_F(RunFolderTest, OpeningAFolderChangesNothingInIt) {
  finish(2);
  RunFolder(configuration_).writeSummary(1.0);
  const auto before = fingerprintOf(scratch_.file("run"));
  configuration_.experiment.trials = 5;
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
  configuration_.experiment.seed = 8;
  expectRefused({"experiment/seed: 7 there, 8 here", "another folder"});
  EXPECT_EQ(fingerprintOf(scratch_.file("run")), before);
}

TEST_F(RunFolderTest, TrialsMayGrowTimeLimitsMayDifferAndTheFolderMayBeMoved) {
  finish(2);
  fs::rename(scratch_.file("run"), scratch_.file("moved"));
  configuration_.experiment.runs = scratch_.file("moved");
  configuration_.experiment.trials = 5;
  configuration_.experiment.timeout = 10.0;
  configuration_.sim.watchdog = 10.0;
  RunFolder folder(configuration_);
  EXPECT_EQ(folder.rows().size(), 2u);
  EXPECT_EQ(folder.rows()[1].frames, 60u);
  EXPECT_TRUE(folder.warnings().empty());
  folder.beginRun({2});
  const YAML::Node saved = YAML::LoadFile(scratch_.file("moved/config.yaml"));
  EXPECT_EQ(saved["experiment"]["trials"].as<int>(), 5);
}

TEST_F(RunFolderTest, ThePathOfAPlantsFileMayDifferButNotItsName) {
  configuration_.experiment.plant = "./robot.yaml";
  finish(1);
  configuration_.experiment.plant = "/moved/robot.yaml";
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
  configuration_.experiment.plant = "pendulum_gravity";
  expectRefused({"robot.yaml there, pendulum_gravity here"});
}

TEST_F(RunFolderTest, AnotherValueOfAnyOtherKeyIsRefused) {
  finish(1);
  const Configuration there = configuration_;
  const std::vector<std::pair<std::string, std::function<void(Configuration*)>>> changes = {
      {"experiment/preset: paper there, debug here",
       [](auto* c) { c->experiment.preset = "debug"; }},
      {"goal/tolerance: 10.0 there, 9.0 here", [](auto* c) { c->plant_info.tolerance = 9.0; }},
      {"plant/friction: 1.0 there, 0.5 here",
       [](auto* c) { c->plant = testing::plantOf("{type: pendulum, friction: 0.5}"); }},
      {"camera/noise_std", [](auto* c) { c->camera.noise_std = 0.3; }},
      {"model/encoder_widths",
       [](auto* c) {
         c->model.model.encoder_widths = {25, 12};
       }},
      {"mpc/epsilon: 0.2 there, 0.20000000000000004 here",
       [](auto* c) { c->mpc.epsilon = std::nextafter(0.2, 1.0); }}};
  for (const auto& change : changes) {
    configuration_ = there;
    change.second(&configuration_);
    expectRefused({change.first});
  }
}

/// Behaves like a plant of a model file with this digest.
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
      {"robot/crop: [0, 0, 0, 0] there, [8, 0, 0, 80] here",
       [](auto* c) {
         c->robot->crop = {8, 0, 0, 80};
       }},
      {"robot/goal_file", [](auto* c) { c->robot->goal_file = "/goal.png"; }},
      {"evaluation/goal_distance: 0.0 there, 0.4 here",
       [](auto* c) { c->evaluation.goal_distance = 0.4; }}};
  configuration_.robot = RobotOptions();
  const Configuration there = configuration_;
  begin();
  for (const auto& change : changes) change.second(&configuration_);
  begin();
  EXPECT_EQ(YAML::LoadFile(file("config.yaml"))["robot"]["crop"][0].as<int>(), 8);
  configuration_ = there;
  finish(1);
  for (const auto& change : changes) {
    configuration_ = there;
    change.second(&configuration_);
    expectRefused({change.first, "another folder", "first trial"});
  }
}

TEST_F(RunFolderTest, InLockStepARunIsRecordedWithItsTablesAndOnARobotWithItsBagAlone) {
  const RunId run{0};
  const auto isRecorded = [&] { return RunFolder(configuration_).isRecorded(run); };
  for (const bool robot : {false, true}) {
    configuration_.experiment.runs = scratch_.file(robot ? "robot" : "run");
    if (robot) configuration_.robot = RobotOptions();
    EXPECT_FALSE(isRecorded());
    const std::string bag = RunFolder(configuration_).beginRun(run);
    EXPECT_FALSE(isRecorded());
    writeText(bag, "a bag");
    EXPECT_EQ(isRecorded(), robot);
    RunFolder(configuration_).writeRun(run, {});
    EXPECT_TRUE(isRecorded());
  }
  configuration_.robot->crop[0] = 8;  // images with another crop must not be mixed with later ones
  EXPECT_FALSE(isRecorded());
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

TEST_F(RunFolderTest, AnotherVersionOfTheCodeWarnsAndTheVersionThatBeganStays) {
  finish(1);
  std::string config = textOf(file("config.yaml"));
  config.replace(0, config.find('\n'), "version: 0.0.1 (abc)");
  writeText(file("config.yaml"), config);
  RunFolder folder(configuration_);
  ASSERT_EQ(folder.warnings().size(), 1u);
  EXPECT_TRUE(testing::names(folder.warnings()[0], {"0.0.1 (abc)", codeVersion()}));
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
                                               {scratch_.file("run"), "another process"}));
  auto third = std::make_unique<RunFolder>(toyConfiguration(scratch_.file("new")));
  RunFolder fourth(toyConfiguration(scratch_.file("new")));
  third->beginRun({0});
  third.reset();  // releases the lock
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { fourth.beginRun({0}); },
                                               {scratch_.file("new"), "was begun", "meanwhile"}));
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

}  // namespace
}  // namespace ddm
