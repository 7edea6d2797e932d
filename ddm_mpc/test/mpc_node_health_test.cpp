// Tests of what mpc_node reports while it runs: plan_scalars and /diagnostics.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>

#include "trial_client.h"

namespace ddm {
namespace {

using diagnostic_msgs::DiagnosticStatus;

class MpcNodeHealthTest : public MpcNodeTest {
 protected:
  MpcNodeHealthTest() : MpcNodeTest("/health") {}

  void SetUp() override {
    MpcNodeTest::SetUp();
    // Each count is told once, and other nodes publish /diagnostics, too.
    ASSERT_TRUE(waitUntil([this] { return !status("plan").name.empty(); }));
  }

  /// Starts a trial that plans; returns when the node has its model.
  void beginPlanning(std::uint32_t num_steps, double epsilon) {
    const ddm_msgs::Model model = modelOfSeed(31);
    ddm_msgs::RunTrialGoal goal = trialGoal(num_steps, epsilon, model.id);
    goal.start = stamps_.emplace_back(client_.publishImage(kSize, 0));
    client_.publish(model);
    begin(goal);
    ASSERT_TRUE(waitUntil([this] { return torque_.messages.size() == 1; }));
  }

  /// Calls a function with all statuses of this name, the oldest first.
  void forEachStatus(const std::string& name,
                     const std::function<void(const DiagnosticStatus&)>& function) const {
    for (const diagnostic_msgs::DiagnosticArray& array : diagnostics_.messages) {
      for (const DiagnosticStatus& status : array.status) {
        if (status.name == "health/mpc_node: " + name) function(status);
      }
    }
  }
  /// The newest status of this name, empty if there is none yet.
  DiagnosticStatus status(const std::string& name) const {
    DiagnosticStatus newest;
    forEachStatus(name, [&newest](const DiagnosticStatus& status) { newest = status; });
    return newest;
  }
  /// Sum of the numbers with which the reports of this name begin, such as "20 plans, ...".
  double sumOf(const std::string& name) const {
    double sum = 0.0;
    forEachStatus(name, [&sum](const DiagnosticStatus& report) {
      sum += std::strtod(report.message.c_str(), nullptr);
    });
    return sum;
  }
  ::testing::AssertionResult reports(const std::string& name, std::uint8_t level,
                                     const std::string& part) {
    if (waitUntil([&] {
          const DiagnosticStatus now = status(name);
          return now.level == level && now.message.find(part) != std::string::npos;
        })) {
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "it is: " << status(name);
  }

  Listener<diagnostic_msgs::DiagnosticArray> diagnostics_{client_.nh, "/diagnostics"};
};

TEST_F(MpcNodeHealthTest, TellsHowFarTheGoalIsAndHowWrongTheLastPredictionWas) {
  Listener<ddm_msgs::PlanScalars> scalars(client_.nh, topics::kPlanScalars);
  ASSERT_TRUE(waitUntil([&] { return scalars.connected(); }));
  beginPlanning(12, 0.3);
  show(12);
  expectEnd(State::SUCCEEDED);
  const std::size_t num_plans = 12 - action_.getResult()->num_exploratory;
  ASSERT_TRUE(num_plans > 2 && num_plans < 12) << num_plans;
  ASSERT_TRUE(waitUntil(
      [&] { return scalars.messages.size() == num_plans && plan_.messages.size() == num_plans; }));
  const auto feature = [this](std::size_t plan, Eigen::Index step) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(&plan_.messages[plan].feature[2 * step], 2));
  };
  std::size_t i = 0;
  for (std::size_t step = 0; step < 12; ++step) {
    if (torque_.messages[step].exploratory != 0) continue;
    const ddm_msgs::Plan& plan = plan_.messages[i];
    const ddm_msgs::PlanScalars& numbers = scalars.messages[i];
    const Eigen::Map<const Eigen::VectorXd> goal(plan.goal_feature.data(), 2);
    EXPECT_EQ(numbers.header.stamp, plan.header.stamp);
    EXPECT_EQ(numbers.cost, plan.cost);
    EXPECT_EQ(numbers.solve_time, plan.solve_time);
    EXPECT_DOUBLE_EQ(numbers.goal_distance, (feature(i, 0) - goal).norm() / kSpread);
    if (step == 0 || torque_.messages[step - 1].exploratory != 0) {
      EXPECT_TRUE(std::isnan(numbers.prediction_error)) << "nothing was predicted";
    } else {
      EXPECT_DOUBLE_EQ(numbers.prediction_error, (feature(i, 0) - feature(i - 1, 1)).norm());
      EXPECT_GT(numbers.prediction_error, 0.0);
    }
    ++i;
  }
}

TEST_F(MpcNodeHealthTest, ReportsCameraTorqueAndPlansOfATrial) {
  beginPlanning(20, 0.0);
  show(20);
  expectEnd(State::SUCCEEDED);
  const std::string model_id = modelOfSeed(31).id;
  EXPECT_TRUE(waitUntil([&] {
    return sumOf("plan") >= 20.0 && sumOf("camera") > 0.0 && sumOf("torque") > 0.0 &&
           status("model").message.find(model_id) != std::string::npos;
  })) << status("camera")
      << status("torque") << status("plan") << status("model");
  for (const char* name : {"camera", "torque", "plan", "model"}) {
    EXPECT_EQ(status(name).level, DiagnosticStatus::OK) << status(name);
  }
}

TEST_F(MpcNodeHealthTest, WarnsWhileATrialWaitsForAnImageOrItsModel) {
  begin(trialGoal(2, 1.0));
  EXPECT_TRUE(reports("camera", DiagnosticStatus::WARN, "no image for "));
  EXPECT_TRUE(reports("torque", DiagnosticStatus::WARN, "no torque for "));
  show(2);
  expectEnd(State::SUCCEEDED);
  EXPECT_TRUE(reports("camera", DiagnosticStatus::OK, "images/s"));

  begin(trialGoal(2, 0.0, "0badc0de"));
  EXPECT_TRUE(reports("model", DiagnosticStatus::WARN, "waiting"));
  action_.cancelGoal();
  expectEnd(State::PREEMPTED);
  EXPECT_TRUE(reports("model", DiagnosticStatus::OK, "of trial "));
}

TEST_F(MpcNodeHealthTest, ATrialDoesNotBeginWithAnImageOfAnEarlierTrialAfterTheClockIsSetBack) {
  begin(trialGoal(2, 1.0));
  show(2);
  expectEnd(State::SUCCEEDED);
  client_.passTime(-100.0);
  ddm_msgs::RunTrialGoal goal = trialGoal(1, 1.0);
  goal.start = client_.nextStamp();
  begin(goal);
  EXPECT_TRUE(reports("camera", DiagnosticStatus::WARN, "no image for "));  // it is prepared
  EXPECT_EQ(torque_.messages.size(), 2U);
  show(3);
  expectEnd(State::SUCCEEDED);
  EXPECT_EQ(torque_.messages.back().header.stamp, stamps_.back());
}

TEST_F(MpcNodeHealthTest, ReportsPlansThatFailAsAnError) {
  RandomModelOptions options;
  options.gain = 1e200;
  const ddm_msgs::Model model = modelMessage(randomModel(options));
  ddm_msgs::RunTrialGoal goal = trialGoal(1, 0.0, model.id);
  goal.start = client_.publishImage(kSize, 0);
  client_.publish(model);
  begin(goal);
  expectEnd(State::SUCCEEDED);
  EXPECT_TRUE(waitUntil([this] {
    bool failed = false;
    forEachStatus("plan", [&](const DiagnosticStatus& report) {
      failed = failed || (report.level == DiagnosticStatus::ERROR &&
                          report.message.find("1 of 1 plans") == 0);
    });
    return failed;
  }));
}

}  // namespace
}  // namespace ddm
