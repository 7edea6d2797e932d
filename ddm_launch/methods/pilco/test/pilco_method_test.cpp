// Tests of the PILCO methods: their files, what one training passes to the next, and refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/pilco_method.h"

#include <ddm_common/param_reader.h>
#include <ddm_model/minimise.h>
#include <ddm_model/testing/random_matrix.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/parameter_reference.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include <boost/algorithm/string.hpp>
#include <boost/filesystem.hpp>
#include <cmath>
#include <sstream>

#include "algorithm1.h"
#include "in_process_driver.h"
#include "method.h"
#include "toy_run.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::randomMatrix;
using testing::textOf;
using testing::throwsNaming;
using testing::writeText;

constexpr char kSmall[] =
    "pilco: {hyperparameter_iterations: 20, policy_evaluations: 5, max_points: 40, "
    "first_inducing_iterations: 3}\n";

/// A small experiment with one of the PILCO methods.
Configuration smallConfiguration(const std::string& method, const std::string& runs) {
  Configuration all = testing::toyConfiguration(runs);
  all.experiment.method = method;
  all.mpc.epsilon = 0.0;
  all.model.model.pca_dim = 5;
  all.model.training.max_iterations = 10;
  all.model.training.schedule = method == "pilco_features" ? "v_r_only" : "joint";
  ParamReader reader(YAML::Load(kSmall));
  all.method_blocks = methodKind(method).readBlocks(&reader);
  reader.requireValid();
  return all;
}

void runSmall(const Configuration& configuration) {
  InProcessDriver driver(configuration);
  RunFolder folder(configuration);
  std::ostringstream out;
  Progress progress(&out, false, configuration.experiment.trials);
  runExperiment(configuration, &driver, &folder, &progress);
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The number in a column of a row.
/// @param column  counted from 0
double numberAt(const std::string& row, size_t column) {
  std::vector<std::string> columns;
  boost::split(columns, row, boost::is_any_of(","));
  return std::stod(columns.at(column));
}

/// Replaces the list of numbers `key` in a file of YAML.
template <class Change>
void changeList(const std::string& file, const std::string& key, const Change& change) {
  YAML::Node root = YAML::LoadFile(file);
  auto numbers = root[key].as<std::vector<double>>();
  change(&numbers);
  root[key] = numbers;
  writeText(file, YAML::Dump(root));
}

class PilcoMethodTest : public ::testing::Test {
 protected:
  PilcoMethodTest() { silenceSolverLog(); }
  std::string folder(const std::string& name) const { return scratch_.file(name); }
  /// The bags of the first three trials of the folder "run".
  std::vector<std::string> threeBags() const {
    std::vector<std::string> bags;
    for (const std::string trial : {"000", "001", "002"}) {
      bags.push_back(folder("run") + "/trial_" + trial + "/trial.bag");
    }
    return bags;
  }

  testing::TempFolder scratch_;
};

TEST_F(PilcoMethodTest, LostFramesAreRefused) {
  for (const std::string method : {"pilco_state", "pilco_features", "pilco_pca"}) {
    Configuration all = smallConfiguration(method, folder(method));
    all.camera.drop_rate = 0.05;
    EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { InProcessDriver driver(all); },
                                                    {"camera/drop_rate", "PILCO", "got 0.05"}))
        << method;
  }
}

TEST_F(PilcoMethodTest, EveryBaselineRunsAndLeavesItsFiles) {
  for (const std::string method : {"pilco_state", "pilco_features", "pilco_pca"}) {
    const Configuration all = smallConfiguration(method, folder(method));
    runSmall(all);
    const std::vector<std::string> rows = linesOf(textOf(folder(method) + "/trials.csv"));
    ASSERT_EQ(rows.size(), 4u) << method;  // header, random trial and two more trials
    EXPECT_EQ(rows[3].substr(0, 6), "7,2,90") << method;
    EXPECT_NE(rows[3].find(",,,"), std::string::npos) << method << ": no V_R, no V_P: " << rows[3];
    const std::vector<std::string> prediction =
        linesOf(textOf(folder(method) + "/trial_002/prediction.csv"));
    EXPECT_EQ(prediction.size(), 2u + testing::kToySteps) << method;  // header and initial state
    EXPECT_EQ(fs::exists(folder(method) + "/trial_002/model.ddm"), method == "pilco_features");
    const YAML::Node report = YAML::LoadFile(folder(method) + "/trial_002/pilco.yaml");
    EXPECT_EQ(report["points"].as<int>(), 3 * (testing::kToySteps - 1)) << method;
    EXPECT_TRUE(report["sparse"].as<bool>()) << method;
    EXPECT_LE(report["cost_after"].as<double>(), report["cost_before"].as<double>()) << method;
  }
}

TEST_F(PilcoMethodTest, ARunThatIsResumedGoesOnWithItsPolicyAndEndsLikeOneThatIsNot) {
  for (const std::string method : {"pilco_state", "pilco_features", "pilco_pca"}) {
    const std::string whole = folder("whole_" + method), parts = folder("parts_" + method);
    runSmall(smallConfiguration(method, whole));
    Configuration resumed = smallConfiguration(method, parts);
    resumed.experiment.trials = 1;
    runSmall(resumed);
    resumed.experiment.trials = 2;
    std::vector<std::string> bags = {parts + "/trial_000/trial.bag",
                                     parts + "/trial_001/trial.bag"};
    InProcessDriver driver(resumed);
    EXPECT_TRUE(driver.resume(parts + "/trial_001", bags, {7, 1, false}));
    EXPECT_FALSE(driver.resume(parts + "/trial_002", bags, {7, 1, false}));
    runSmall(resumed);
    for (const std::string name : {"trial_002/torques.csv", "trial_002/prediction.csv",
                                   "evaluation_002/torques.csv", "evaluation_002/trajectory.csv"}) {
      EXPECT_EQ(textOf(whole + "/" + name), textOf(parts + "/" + name)) << method << " " << name;
      EXPECT_FALSE(textOf(whole + "/" + name).empty()) << name;
    }
    // resume() uses the policy of the file, and does not repeat the training.
    changeList(parts + "/trial_002/pilco.yaml", "policy",
               [](std::vector<double>* policy) { policy->assign(policy->size(), 0.0); });
    resumed.experiment.trials = 3;
    resumed.trial.num_steps = testing::kToySteps;
    runSmall(resumed);
    const std::string torques = textOf(parts + "/trial_003/torques.csv");
    EXPECT_NE(torques.find("\n5,0,0\n"), std::string::npos) << method << "\n" << torques;
  }
}

TEST_F(PilcoMethodTest, APolicyGoesOnFromTheLastOneWhereTheCoordinatesStay) {
  const Configuration all = smallConfiguration("pilco_state", folder("run"));
  runSmall(all);
  const auto report = [&](int trial) {
    return YAML::LoadFile(folder("run") + "/trial_00" + std::to_string(trial) + "/pilco.yaml");
  };
  const std::string file = folder("run") + "/trial_001/pilco.yaml";
  EXPECT_EQ(report(1)["policy"].size(), 3u + 30u * 3u + 30u);
  EXPECT_EQ(report(1)["hyperparameters"].size(), 6u * 2u);
  EXPECT_EQ(report(1)["inducing"].size(), 4u * 40u);
  // With another initial policy, the training of trial 2 has another result.
  changeList(file, "policy", [](std::vector<double>* policy) {
    for (double& parameter : *policy) parameter *= 1.1;
  });
  InProcessDriver driver(all);
  const TrainingOutcome outcome = driver.train(threeBags(), {7, 2, false}, [](double) {});
  const YAML::Node now = YAML::Load(outcome.files.at("pilco.yaml"));
  EXPECT_NE(now["cost_before"].as<double>(), report(2)["cost_before"].as<double>());
  EXPECT_NE(YAML::Dump(now["policy"]), YAML::Dump(report(2)["policy"]));
}

TEST_F(PilcoMethodTest, AMissingOrDamagedMemoryIsNamed) {
  const Configuration all = smallConfiguration("pilco_state", folder("run"));
  runSmall(all);
  const std::string file = folder("run") + "/trial_001/pilco.yaml";
  const auto train = [&] { InProcessDriver(all).train(threeBags(), {7, 2, false}, [](double) {}); };
  const std::string good = textOf(file);
  for (const std::string key : {"policy", "hyperparameters", "inducing"}) {
    writeText(file, good);
    changeList(file, key, [](std::vector<double>* numbers) { numbers->pop_back(); });
    EXPECT_TRUE(throwsNaming<std::runtime_error>(train, {file, key, "another run"}));
  }
  for (const std::string text : {"policy: [[1, 2]]\n", "[]\n", "policy: 3\n", "{"}) {
    writeText(file, text);
    EXPECT_TRUE(throwsNaming<std::runtime_error>(train, {file, "another run"})) << text;
  }
  fs::remove(file);
  EXPECT_TRUE(throwsNaming<std::runtime_error>(train, {file}));
}

TEST_F(PilcoMethodTest, WhatIsPredictedIsWhatHappensAndItIsBetterThanTheFirstPolicy) {
  Configuration all = smallConfiguration("pilco_state", folder("run"));
  all.experiment.trials = 0;
  all.trial.num_steps = 12;
  all.trial.episodes = 5;
  testing::usePlant(testing::plantOf("{type: pendulum, start_std: 0.01}"), &all);
  ParamReader reader(YAML::Load("pilco: {policy_evaluations: 60}"));
  all.method_blocks = methodKind("pilco_state").readBlocks(&reader);
  runSmall(all);
  const YAML::Node report = YAML::LoadFile(folder("run") + "/trial_000/pilco.yaml");
  EXPECT_LT(report["cost_after"].as<double>(), 0.9 * report["cost_before"].as<double>());
  const std::vector<std::string> predicted =
      linesOf(textOf(folder("run") + "/trial_000/prediction.csv"));
  const std::vector<std::string> actual =
      linesOf(textOf(folder("run") + "/evaluation_000/trajectory.csv"));
  ASSERT_EQ(predicted.size(), 14u);
  double cost = 0.0;
  for (size_t row = 1; row < predicted.size(); ++row) {
    // the columns are step, time_s, rate and its std, angle
    const double angle = numberAt(predicted[row], 4);
    // The evaluation ends one step earlier, with its last image.
    if (row < actual.size()) {
      EXPECT_NEAR(angle, numberAt(actual[row], 2), 0.35) << "step " << row - 1;
    }
    if (row > 1) cost += numberAt(predicted[row], 6);
  }
  EXPECT_NEAR(cost, report["cost_after"].as<double>(), 1e-6);
  // the pendulum has moved towards the goal
  EXPECT_GT(std::abs(numberAt(predicted.back(), 4)), 1.5);
}

/// An observation of random numbers. The inverse squares of its length-scales are infinite, so that
/// no cost is finite.
class PointlessObservation : public Observation {
 public:
  std::vector<std::string> names() const override { return {"z_1"}; }
  ObservedData learn(const std::vector<std::string>& /*bags*/, const DataSet& data,
                     const TrialId& /*id*/) override {
    const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(1);
    const pilco::StateCost cost(pilco::replaceAngles(1, {}), zero, one);
    return {randomMatrix(1, data.numFrames(), 1),
            {{}, false, {zero, one}, cost, Eigen::VectorXd::Constant(1, 1e-200)}};
  }
  Eigen::VectorXd observe(const Image& /*image*/) override { return Eigen::VectorXd::Zero(1); }
};

TEST_F(PilcoMethodTest, GoesOnWithAFirstPolicyWhereNoCostIsFinite) {
  const Configuration all = smallConfiguration("pilco_state", folder("run"));
  runSmall(all);
  const auto method =
      makePilcoMethod(all, pilco::PilcoOptions(), std::make_unique<PointlessObservation>());
  const TrainingOutcome outcome =
      method->train({folder("run") + "/trial_000/trial.bag"}, {7, 0, false}, [](double) {});
  const YAML::Node report = YAML::Load(outcome.files.at("pilco.yaml"));
  EXPECT_NE(report["message"].as<std::string>().find("not finite"), std::string::npos);
  EXPECT_TRUE(report["cost_before"].IsNull() && report["cost_after"].IsNull());
  const std::shared_ptr<Policy> policy = method->policy();
  ASSERT_NE(policy, nullptr);
  policy->startTrial({7, 0, true});
  policy->observe({});
  const Answer answer = policy->answer();  // no torque of the policy is finite
  EXPECT_EQ(answer.torque[0], 0.0);
  EXPECT_FALSE(answer.plan);
}

TEST_F(PilcoMethodTest, AScheduleThatDoesNotFitTheMethodIsRefused) {
  for (const std::string method : {"ddm", "pilco_features"}) {
    Configuration all = smallConfiguration(method, folder(method));
    all.model.training.schedule = method == "ddm" ? "v_r_only" : "joint";
    EXPECT_TRUE(throwsNaming<std::invalid_argument>(
        [&] { InProcessDriver driver(all); },
        {"training/schedule", "got " + all.model.training.schedule}));
  }
}

TEST(PilcoOptions, HaveTheDefaultsOfTheParameterReferenceInItsOrderAndReportAllProblems) {
  testing::expectDefaults<pilco::PilcoOptions>(DDM_PILCO_REFERENCE, "pilco");
  ParamReader invalid(YAML::Load(
      "pilco: {hyperparameter_iterations: -1, hyperparameter_points: 1, max_points: 0,"
      " first_inducing_iterations: -1, inducing_iterations: -1, policy_evaluations: 0}"));
  invalid.read<pilco::PilcoOptions>("pilco");
  EXPECT_EQ(invalid.problems().size(), 6U);
}

TEST_F(PilcoMethodTest, ASavedConfigurationCanBeGivenAgain) {
  Configuration all = smallConfiguration("pilco_state", folder("run"));
  testing::usePlant(testing::plantOf("{type: pendulum}"), &all);
  ParamReader reader(toYaml(all));
  const Configuration again = readWithMethod(&reader);
  EXPECT_EQ(YAML::Dump(again.method_blocks), YAML::Dump(all.method_blocks));
}

}  // namespace
}  // namespace ddm
