// Tests of Algorithm 1: the order of its phases, its calls of the driver, and how it resumes.
// SPDX-License-Identifier: BSD-3-Clause
#include "algorithm1.h"

#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>

#include "tables.h"
#include "toy_run.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::kToySteps;
using testing::ObedientDriver;
using testing::textOf;
using testing::throwsNaming;
using testing::toyConfiguration;

using Calls = std::vector<std::string>;

class ExperimentTest : public ::testing::Test {
 protected:
  ExperimentTest() { driver_.state = Eigen::Vector2d(3.14159265358979323846, 0.0); }

  void run() {
    RunFolder folder(configuration_);
    std::ostringstream out;
    Progress progress(&out, /*live=*/false, configuration_.experiment.trials);
    shown_.clear();
    runExperiment(configuration_, &driver_, &folder, &progress,
                  [this](const std::vector<TrialRow>& rows) { shown_.push_back(rows.size()); });
    terminal_ = out.str();
  }

  std::string file(const std::string& name) const { return scratch_.file("run/" + name); }
  size_t numRows() const {
    const std::string text = textOf(file("trials.csv"));
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n')) - 1;
  }

  testing::TempFolder scratch_;
  Configuration configuration_ = toyConfiguration(scratch_.file("run"));
  ObedientDriver driver_;
  std::string terminal_;
  std::vector<size_t> shown_;  ///< number of rows in each call of `show`
};

TEST_F(ExperimentTest, EachTrialIsRunThenLearnedFromThenEvaluated) {
  run();
  EXPECT_EQ(driver_.calls, (Calls{"run 0", "train 0", "evaluate 0", "run 1", "train 1",
                                  "evaluate 1", "run 2", "train 2", "evaluate 2"}));
  EXPECT_EQ(shown_, (std::vector<size_t>{0, 1, 2, 3}));
  driver_.calls.clear();
  fs::remove(file("summary.yaml"));  // as if the experiment had been stopped before the summary
  run();
  EXPECT_EQ(driver_.calls, Calls());
  EXPECT_TRUE(fs::exists(file("summary.yaml")));
  configuration_.experiment.trials = 3;
  run();
  EXPECT_EQ(driver_.calls,
            (Calls{"use " + file("trial_002/model.ddm"), "run 3", "train 3", "evaluate 3"}));
  EXPECT_EQ(shown_, (std::vector<size_t>{3, 4}));
}

TEST_F(ExperimentTest, TheFirstTrialIsRandomTheOthersExploreAndEvaluationsAreGreedy) {
  configuration_.mpc.epsilon = 0.3;
  configuration_.mpc.hold_steps = 4;
  run();
  ASSERT_EQ(driver_.requests.size(), 6u);
  EXPECT_EQ(driver_.requests[0].epsilon, 1.0);
  EXPECT_EQ(driver_.requests[2].epsilon, 0.3);
  EXPECT_EQ(driver_.requests[4].epsilon, 0.3);
  for (const size_t evaluation : {1, 3, 5}) EXPECT_EQ(driver_.requests[evaluation].epsilon, 0.0);
  for (size_t i = 0; i < driver_.requests.size(); ++i) {
    EXPECT_EQ(driver_.requests[i].hold_steps, 4);
    EXPECT_EQ(driver_.requests[i].num_steps, kToySteps);
    EXPECT_EQ(driver_.requests[i].id.seed, 7u);
    EXPECT_EQ(driver_.requests[i].id.trial, i / 2);
    EXPECT_EQ(driver_.requests[i].id.evaluation, i % 2 == 1);
  }
}

TEST_F(ExperimentTest, BagsToStartFromCountAsTrialsBeforeTheFirst) {
  const Calls before = {scratch_.file("a.bag"), scratch_.file("b.bag")};
  for (const std::string& bag : before) testing::writeToyBag(bag);
  configuration_.start.bags = before;
  configuration_.experiment.trials = 0;
  run();
  EXPECT_EQ(driver_.calls, (Calls{"train 0", "run 0", "train 0", "evaluate 0"}));
  EXPECT_LT(driver_.requests[0].epsilon, 1.0);
  EXPECT_EQ(driver_.bags_of_training[0], before);
  EXPECT_EQ(driver_.bags_of_training[1],
            (Calls{before[0], before[1], file("trial_000/trial.bag")}));
  driver_.calls.clear();
  configuration_.experiment.trials = 1;  // resumed: the block `start` is not used a second time
  run();
  EXPECT_EQ(driver_.calls,
            (Calls{"use " + file("trial_000/model.ddm"), "run 1", "train 1", "evaluate 1"}));
}

TEST_F(ExperimentTest, ATrialOfSeveralEpisodesIsThatManyRunsWithDrawsAndBagsOfTheirOwn) {
  configuration_.trial.episodes = 2;
  configuration_.experiment.trials = 1;
  run();
  EXPECT_EQ(driver_.calls, (Calls{"run 0", "run 1", "train 0", "evaluate 0", "run 2", "run 3",
                                  "train 1", "evaluate 1"}));
  const Calls first = {file("trial_000/trial.bag"), file("trial_000/episode_001/trial.bag")};
  EXPECT_EQ(driver_.bags_of_training[0], first);
  EXPECT_EQ(driver_.bags_of_training[1], (Calls{first[0], first[1], file("trial_001/trial.bag"),
                                                file("trial_001/episode_001/trial.bag")}));
  for (const std::string& bag : driver_.bags_of_training[1]) {
    EXPECT_TRUE(fs::exists(fs::path(bag).parent_path() / "torques.csv")) << bag;
  }
  configuration_.experiment.trials = 2;
  fs::remove(first[1]);
  EXPECT_TRUE(throwsNaming<std::runtime_error>([this] { run(); }, {first[1], "missing"}));
}

TEST_F(ExperimentTest, EvaluationsAreRecordedOnRequestAloneAndNeverLearnedFrom) {
  configuration_.evaluation.record = true;
  run();
  for (const TrialRequest& request : driver_.requests) EXPECT_FALSE(request.bag.empty());
  EXPECT_TRUE(fs::exists(file("evaluation_001/trial.bag")));
  configuration_ = toyConfiguration(scratch_.file("run"));
  fs::remove_all(scratch_.file("run"));
  driver_.requests.clear();
  driver_.bags_of_training.clear();
  run();
  for (const TrialRequest& request : driver_.requests) {
    EXPECT_EQ(request.bag.empty(), request.id.evaluation);
  }
  ASSERT_EQ(driver_.bags_of_training.size(), 3u);
  EXPECT_EQ(driver_.bags_of_training[0], (Calls{file("trial_000/trial.bag")}));
  EXPECT_EQ(driver_.bags_of_training[2],
            (Calls{file("trial_000/trial.bag"), file("trial_001/trial.bag"),
                   file("trial_002/trial.bag")}));
}

TEST_F(ExperimentTest, ARowTellsFramesSuccessAndPlanTimesOfTheGreedyRun) {
  configuration_.experiment.trials = 0;
  run();
  EXPECT_EQ(textOf(file("trials.csv")).substr(textOf(file("trials.csv")).find('\n') + 1),
            "7,0,30,1,1,0.0,0.5,0.25,2.000,0,15.000,30.000," + codeVersion() + ",\n");
}

TEST_F(ExperimentTest, ARowTellsTheErrorInTheUnitOfThePlantAndItsReturn) {
  testing::ToyPlant::Traits traits;
  traits.reward = [](const Eigen::VectorXd& state, const Eigen::VectorXd& torque) {
    return -2.0 * state[0] - torque[0];
  };
  testing::usePlant(testing::plantOf(traits), &configuration_);
  configuration_.experiment.trials = 0;
  driver_.state = (Eigen::VectorXd(2) << 0.75, 0.0)
                      .finished();  // 0.25 m from the goal; the torques are 0, 0.1, ... 2.9
  run();
  const TrialRow row = parseTrialsCsv(textOf(file("trials.csv")), "trials.csv").at(0);
  EXPECT_EQ(row.evaluation.final_error, 0.25);
  EXPECT_FALSE(row.evaluation.success);
  EXPECT_NEAR(row.evaluation.total_reward.value(), -2.0 * 0.75 * 30 - 1.2 * 43.5, 1e-9);
  EXPECT_EQ(YAML::LoadFile(file("config.yaml"))["goal"]["error_unit"].as<std::string>(), "m");
}

TEST_F(ExperimentTest, AGreedyRunIsJudgedByTheGoalThatWasDrawnForIt) {
  const auto plant = testing::plantOf(testing::colourfulToy());
  testing::usePlant(plant, &configuration_);
  const std::unique_ptr<Plant> alone = plant->make();
  driver_.state = goalOf(*alone, {7, 1, /*evaluation=*/true});
  run();
  const auto rows = parseTrialsCsv(textOf(file("trials.csv")), "trials.csv");
  ASSERT_EQ(rows.size(), 3u);
  for (std::uint32_t trial = 0; trial < 3; ++trial) {
    const double goal = goalOf(*alone, {7, trial, true})[0];
    EXPECT_EQ(rows[trial].evaluation.final_error, std::abs(driver_.state[0] - goal)) << trial;
    EXPECT_EQ(rows[trial].evaluation.success, trial == 1) << trial;
  }
}

TEST_F(ExperimentTest, WithoutGroundTruthSuccessIsThatInFeatures) {
  driver_.goal_distance = 0.2;
  configuration_.evaluation.goal_distance = 0.3;
  // with ground truth, the distance in features does not count
  driver_.state = Eigen::VectorXd::Zero(2);
  configuration_.experiment.trials = 0;
  run();
  EXPECT_NE(textOf(file("trials.csv")).find("\n7,0,30,0,0,180.0,"), std::string::npos)
      << textOf(file("trials.csv"));
  driver_.state.resize(0);
  configuration_.experiment.runs = scratch_.file("robot");
  run();
  const std::string rows = textOf(scratch_.file("robot/trials.csv"));
  EXPECT_NE(rows.find("\n7,0,30,1,1,,"), std::string::npos) << rows;
}

TEST_F(ExperimentTest, AnExperimentWhoseModelsCannotBeSavedTrainsOnceAndGoesOn) {
  driver_.has_models = false;
  configuration_.experiment.trials = 1;
  run();
  driver_.calls.clear();
  configuration_.experiment.trials = 2;
  run();
  EXPECT_EQ(driver_.calls, (Calls{"train 1", "run 2", "train 2", "evaluate 2"}));
  EXPECT_EQ(numRows(), 3u);
  EXPECT_NE(terminal_.find("after trial 1"), std::string::npos) << terminal_;
}

TEST_F(ExperimentTest, AFinishedExperimentIsSummedUpAndOnlyTheTimeOfItsVerdictChanges) {
  run();
  const std::string summary = textOf(file("summary.yaml"));
  auto before = testing::fingerprintOf(scratch_.file("run"));
  driver_.calls.clear();
  for (const int trials : {2, 1}) {
    configuration_.experiment.trials = trials;
    run();
    EXPECT_EQ(driver_.calls, Calls());
    EXPECT_NE(terminal_.find("finished already"), std::string::npos) << terminal_;
    EXPECT_NE(terminal_.find("3 models trained"), std::string::npos) << terminal_;
    auto after = testing::fingerprintOf(scratch_.file("run"));
    EXPECT_NE(after[file("summary.yaml")], before[file("summary.yaml")]);
    EXPECT_EQ(textOf(file("summary.yaml")), summary);
    before[file("summary.yaml")] = after[file("summary.yaml")];
    EXPECT_EQ(after, before);
  }
}

TEST_F(ExperimentTest, ADriverThatFailsBeforeTheFirstResultLeavesTheFolderAsItWas) {
  configuration_.start.bags = {"/a.bag"};
  driver_.fails_at = 1;  // call 1 is "train 0"
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_FALSE(fs::exists(scratch_.file("run")));
  configuration_ = toyConfiguration(scratch_.file("run"));
  driver_ = ObedientDriver();
  run();
  const auto before = testing::fingerprintOf(scratch_.file("run"));
  configuration_.experiment.trials = 3;
  driver_ = ObedientDriver();
  driver_.fails_at = 1;  // call 1 loads the model of trial 2
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_EQ(testing::fingerprintOf(scratch_.file("run")), before);
}

TEST_F(ExperimentTest, OnlyTheEpisodesThatAreNotRecordedAreRunAgain) {
  configuration_.trial.episodes = 2;
  configuration_.experiment.trials = 0;
  driver_.fails_at = 2;  // call 2 is "run 1", the second episode of trial 0
  EXPECT_THROW(run(), std::runtime_error);
  const std::string bag = textOf(file("trial_000/trial.bag"));
  driver_ = ObedientDriver();
  run();
  EXPECT_EQ(driver_.calls, (Calls{"run 1", "train 0", "evaluate 0"}));
  EXPECT_EQ(textOf(file("trial_000/trial.bag")), bag);
}

TEST_F(ExperimentTest, ARecordingThatCannotBeReadIsRefusedAndKept) {
  driver_.fails_at = 2;  // call 2 is "train 0"
  EXPECT_THROW(run(), std::runtime_error);
  testing::writeText(file("trial_000/trial.bag"), "no bag");
  driver_ = ObedientDriver();
  EXPECT_TRUE(throwsNaming<std::runtime_error>(
      [this] { run(); }, {file("trial_000/trial.bag"), "trial 0", "move it away"}));
  EXPECT_EQ(driver_.calls, Calls());
  EXPECT_EQ(textOf(file("trial_000/trial.bag")), "no bag");
}

TEST_F(ExperimentTest, ATrainingIsRepeatedWhereItsTrialIsRecordedAgain) {
  driver_.fails_at = 3;  // call 3 is "evaluate 0"
  EXPECT_THROW(run(), std::runtime_error);
  fs::remove(file("trial_000/trial.bag"));
  driver_ = ObedientDriver();
  driver_.fails_at = 2;  // call 2 is "train 0"
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_EQ(driver_.calls, (Calls{"run 0", "train 0"}));
  driver_ = ObedientDriver();
  configuration_.experiment.trials = 0;
  run();
  EXPECT_EQ(driver_.calls, (Calls{"train 0", "evaluate 0"}));
}

TEST_F(ExperimentTest, AnErrorOfThePlantThatIsNotFiniteIsRefusedWithPlantFrameAndValue) {
  testing::ToyPlant::Traits traits;
  traits.distance = [](const Eigen::VectorXd& state, const Eigen::VectorXd& goal) {
    return state[0] == 7.0 ? std::nan("") : std::abs(state[0] - goal[0]);
  };
  testing::usePlant(testing::plantOf(traits), &configuration_);
  driver_.state = Eigen::Vector2d(7.0, 0.0);
  EXPECT_TRUE(throwsNaming<std::range_error>([this] { run(); },
                                             {"their_package/Toy", "error", "image 0", "nan"}));
  EXPECT_FALSE(fs::exists(file("trials.csv")));
  traits.distance = testing::ToyPlant::Traits().distance;
  traits.reward = [](const Eigen::VectorXd&, const Eigen::VectorXd& torque) {
    return torque[0] == 0.1 * 3 ? std::numeric_limits<double>::infinity() : 0.0;
  };
  testing::usePlant(testing::plantOf(traits), &configuration_);
  EXPECT_TRUE(throwsNaming<std::range_error>([this] { run(); },
                                             {"their_package/Toy", "reward", "image 3", "inf"}));
  EXPECT_FALSE(fs::exists(file("trials.csv")));
}

TEST_F(ExperimentTest, ADriverThatFailsLeavesFinishedWorkToWhichTheSameCallAddsTheRest) {
  driver_ = ObedientDriver();
  run();
  const std::string uninterrupted = textOf(file("trials.csv"));
  const Calls rest[] = {{"use " + file("trial_000/model.ddm"), "run 1", "train 1", "evaluate 1"},
                        {"train 1", "evaluate 1", "run 2", "train 2"},
                        {"use " + file("trial_001/model.ddm"), "evaluate 1", "run 2", "train 2"}};
  for (const size_t call : {4, 5, 6}) {  // "run 1", "train 1", "evaluate 1"
    fs::remove_all(scratch_.file("run"));
    driver_ = ObedientDriver();
    driver_.fails_at = call;
    EXPECT_TRUE(
        throwsNaming<std::runtime_error>([this] { run(); }, {call == 5 ? "ran away" : "camera"}));
    EXPECT_EQ(numRows(), 1u);
    EXPECT_FALSE(fs::exists(file("summary.yaml")));
    driver_ = ObedientDriver();
    run();
    EXPECT_EQ(Calls(driver_.calls.begin(), driver_.calls.begin() + 4), rest[call - 4]);
    EXPECT_EQ(textOf(file("trials.csv")), uninterrupted);
    EXPECT_FALSE(fs::exists(file("trial_001/trial.1.bag")));
  }
}

}  // namespace
}  // namespace ddm
