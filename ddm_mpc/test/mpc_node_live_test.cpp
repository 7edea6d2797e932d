// Tests of mpc_node while it runs: dynamic_reconfigure, plan_scalars, /diagnostics.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_mpc/MpcConfig.h>
#include <ddm_msgs/testing/node_main.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "ddm_mpc/mpc_options.h"
#include "trial_client.h"

namespace ddm {
namespace {

using diagnostic_msgs::DiagnosticStatus;

class MpcNodeLiveTest : public MpcNodeTest {
 protected:
  void SetUp() override {
    MpcNodeTest::SetUp();
    ASSERT_TRUE(waitUntil([this] { return diagnostics_.connected(); }));  // each count is told once
    ASSERT_TRUE(ros::service::waitForService("mpc_node/mpc/set_parameters", 10000));
    turn("horizon", 12);
    turn("control_weight", 0.05);
  }

  /// What dynparam does. @return the values now in force
  static dynamic_reconfigure::Config turn(const std::string& key, double value) {
    dynamic_reconfigure::Reconfigure service;
    service.request.config.doubles.resize(1);
    service.request.config.doubles[0].name = key;
    service.request.config.doubles[0].value = value;
    return call(&service);
  }
  static dynamic_reconfigure::Config turn(const std::string& key, int value) {
    dynamic_reconfigure::Reconfigure service;
    service.request.config.ints.resize(1);
    service.request.config.ints[0].name = key;
    service.request.config.ints[0].value = value;
    return call(&service);
  }
  static dynamic_reconfigure::Config call(dynamic_reconfigure::Reconfigure* service) {
    EXPECT_TRUE(ros::service::call("mpc_node/mpc/set_parameters", *service));
    return service->response.config;
  }

  template <class Value>
  static Value parameter(const std::string& key) {
    Value value = -1;
    EXPECT_TRUE(ros::param::get("mpc_node/mpc/" + key, value));
    return value;
  }

  /// Starts a trial that plans; returns when the node has its model.
  void beginPlanning(std::uint32_t num_steps, double epsilon, bool evaluation = false) {
    const ddm_msgs::Model model = modelOfSeed(31);
    ddm_msgs::RunTrialGoal goal = trialGoal(num_steps, epsilon, model.id);
    goal.evaluation = evaluation ? 1 : 0;
    goal.start = stamps_.emplace_back(client_.publishImage(kSize, 0));
    client_.publish(model);
    begin(goal);
    ASSERT_TRUE(waitUntil([this] { return torque_.messages.size() == 1; }));
  }

  std::size_t numExploratory() const {
    return std::count_if(torque_.messages.begin(), torque_.messages.end(),
                         [](const ddm_msgs::Torque& torque) { return torque.exploratory != 0; });
  }

  /// The newest status of this name, empty if there is none yet.
  DiagnosticStatus status(const std::string& name) const {
    for (auto array = diagnostics_.messages.rbegin(); array != diagnostics_.messages.rend();
         ++array) {
      for (const DiagnosticStatus& status : array->status) {
        if (status.name == "mpc_node: " + name) return status;
      }
    }
    return DiagnosticStatus();
  }
  static std::string valueOf(const DiagnosticStatus& status, const std::string& key) {
    for (const diagnostic_msgs::KeyValue& pair : status.values) {
      if (pair.key == key) return pair.value;
    }
    return "";
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

/// The first test: nothing has been turned yet.
TEST_F(MpcNodeLiveTest, TakesItsFirstValuesFromTheParametersWhateverTheirType) {
  EXPECT_EQ(parameter<int>("horizon"), 12);
  EXPECT_EQ(parameter<double>("control_weight"), 0.05);
  EXPECT_EQ(parameter<double>("epsilon"), 0.0);
  for (const char* key : {"horizon", "control_weight", "epsilon"}) {
    EXPECT_FALSE(client_.logged("mpc/" + std::string(key) + " is ")) << key;
  }
  beginPlanning(2, 0.0);
  show(2);
  expectEnd(State::SUCCEEDED);
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 2; }));
  EXPECT_EQ(plan_.messages[0].horizon, 12U);
}

TEST_F(MpcNodeLiveTest, PlansFromTheNextImageOnWithAHorizonThatIsTurnedInTheMiddleOfATrial) {
  beginPlanning(6, 0.0);
  show(2);
  turn("horizon", 20);
  EXPECT_EQ(parameter<int>("horizon"), 20);
  show(4);
  turn("horizon", 3);
  show(6);
  expectEnd(State::SUCCEEDED);
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 6; }));
  std::vector<std::uint32_t> horizons;
  for (const ddm_msgs::Plan& plan : plan_.messages) {
    horizons.push_back(plan.horizon);
    EXPECT_EQ(plan.torque.size(), plan.horizon);
    EXPECT_EQ(plan.feature.size(), 2 * (plan.horizon + 1));
  }
  EXPECT_EQ(horizons, (std::vector<std::uint32_t>{12, 12, 20, 20, 3, 3}));
  for (const char* part : {"mpc/horizon is 20 ", " was 12 ", " 1 to 1000"}) {
    EXPECT_TRUE(client_.logged(part)) << part;
  }
  EXPECT_EQ(action_.getResult()->num_failed_plans, 0U);
}

TEST_F(MpcNodeLiveTest, KeepsTheTurnedValuesInTheNextTrial) {
  turn("horizon", 7);
  beginPlanning(1, 0.0);
  expectEnd(State::SUCCEEDED);
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 1; }));
  EXPECT_EQ(plan_.messages[0].horizon, 7U);
}

TEST_F(MpcNodeLiveTest, MakesTorqueDearFromTheNextImageOn) {
  beginPlanning(2, 0.0);
  turn("control_weight", 1e6);
  show(2);
  expectEnd(State::SUCCEEDED);
  EXPECT_GT(std::abs(torque_.messages[0].torque[0]), 1e-2);
  EXPECT_LT(std::abs(torque_.messages[1].torque[0]), 1e-4);
}

TEST_F(MpcNodeLiveTest, BringsValuesIntoTheirRangeAndRefusesThoseThatAreNoNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(turn("horizon", 5000).ints[0].value, 1000);
  EXPECT_TRUE(waitUntil([this] { return client_.logged("mpc/horizon is 1000"); }));
  turn("horizon", 12);
  turn("control_weight", infinity);
  EXPECT_TRUE(waitUntil(
      [this] { return client_.logged("mpc/control_weight must") && client_.logged("got inf"); }));
  EXPECT_EQ(parameter<double>("control_weight"), 0.05);
  turn("control_weight", std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(parameter<double>("control_weight"), 0.05);
}

TEST_F(MpcNodeLiveTest, ExploresAsTheGoalSaysUntilEpsilonIsTurnedAndNeverInAnEvaluation) {
  beginPlanning(4, 0.0);
  show(2);
  EXPECT_EQ(numExploratory(), 0U);
  turn("epsilon", 1.0);
  show(4);
  EXPECT_EQ(numExploratory(), 2U);
  expectEnd(State::SUCCEEDED);

  torque_.messages.clear();
  beginPlanning(3, 0.0, /*evaluation=*/true);
  show(3);
  EXPECT_EQ(numExploratory(), 0U);
  expectEnd(State::SUCCEEDED);

  torque_.messages.clear();
  turn("epsilon", 0.0);
  begin(trialGoal(3, 1.0));  // the random trial has no model that could plan instead
  show(3);
  EXPECT_EQ(numExploratory(), 3U);
  expectEnd(State::SUCCEEDED);
}

TEST_F(MpcNodeLiveTest, TellsHowFarTheGoalIsAndHowWrongTheLastPredictionWas) {
  Listener<ddm_msgs::PlanScalars> scalars(client_.nh, topics::kPlanScalars);
  ASSERT_TRUE(waitUntil([&] { return scalars.connected(); }));
  beginPlanning(6, 0.0);
  show(3);
  turn("epsilon", 1.0);
  show(4);
  turn("epsilon", 0.0);
  show(6);
  expectEnd(State::SUCCEEDED);
  ASSERT_TRUE(
      waitUntil([&] { return scalars.messages.size() == 5 && plan_.messages.size() == 5; }));
  const auto feature = [this](std::size_t plan, Eigen::Index step) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(&plan_.messages[plan].feature[2 * step], 2));
  };
  for (std::size_t i = 0; i < 5; ++i) {
    const ddm_msgs::Plan& plan = plan_.messages[i];
    const Eigen::Map<const Eigen::VectorXd> goal(plan.goal_feature.data(), 2);
    EXPECT_EQ(scalars.messages[i].header.stamp, plan.header.stamp);
    EXPECT_EQ(scalars.messages[i].cost, plan.cost);
    EXPECT_EQ(scalars.messages[i].solve_time, plan.solve_time);
    EXPECT_DOUBLE_EQ(scalars.messages[i].goal_distance, (feature(i, 0) - goal).norm() / kSpread);
    if (i == 0 || i == 3) {
      EXPECT_TRUE(std::isnan(scalars.messages[i].prediction_error)) << "nothing was predicted";
    } else {
      EXPECT_DOUBLE_EQ(scalars.messages[i].prediction_error,
                       (feature(i, 0) - feature(i - 1, 1)).norm());
      EXPECT_GT(scalars.messages[i].prediction_error, 0.0);
    }
  }
}

TEST_F(MpcNodeLiveTest, ReportsCameraTorqueAndPlansOfATrial) {
  ASSERT_TRUE(waitUntil([&] { return !diagnostics_.messages.empty(); }));
  beginPlanning(20, 0.0);
  while (torque_.messages.size() < 20U) show(torque_.messages.size() + 1);
  expectEnd(State::SUCCEEDED);
  const std::string model_id = modelOfSeed(31).id;
  EXPECT_TRUE(waitUntil([&] {
    return std::stoi("0" + valueOf(status("plan"), "plans in all")) >= 20 &&
           std::stoi("0" + valueOf(status("camera"), "total")) >= 20 &&
           std::stoi("0" + valueOf(status("torque"), "total")) >= 20 &&
           valueOf(status("model"), "id") == model_id;
  })) << status("camera")
      << status("torque") << status("plan") << status("model");
  for (const char* name : {"camera", "torque", "plan", "model"}) {
    EXPECT_EQ(status(name).level, DiagnosticStatus::OK) << status(name);
  }
  EXPECT_NE(valueOf(status("torque"), "age of the newest [s]"), "");
  // A report with plans in it tells how long they took, one without does not.
  EXPECT_TRUE(waitUntil([&] {
    return std::any_of(diagnostics_.messages.begin(), diagnostics_.messages.end(),
                       [](const diagnostic_msgs::DiagnosticArray& array) {
                         for (const DiagnosticStatus& status : array.status) {
                           const std::string time = valueOf(status, "longest solve time [ms]");
                           if (!time.empty() && std::stod(time) > 0.0) return true;
                         }
                         return false;
                       });
  }));
}

TEST_F(MpcNodeLiveTest, WarnsWhileATrialWaitsForAnImageOrItsModel) {
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

TEST_F(MpcNodeLiveTest, ReportsPlansThatFailAsAnError) {
  RandomModelOptions options;
  options.gain = 1e200;
  const ddm_msgs::Model model = modelMessage(randomModel(options));
  ddm_msgs::RunTrialGoal goal = trialGoal(1, 0.0, model.id);
  goal.start = client_.publishImage(kSize, 0);
  client_.publish(model);
  begin(goal);
  expectEnd(State::SUCCEEDED);
  EXPECT_TRUE(waitUntil([this] {
    return std::any_of(diagnostics_.messages.begin(), diagnostics_.messages.end(),
                       [](const diagnostic_msgs::DiagnosticArray& array) {
                         for (const DiagnosticStatus& status : array.status) {
                           if (status.level == DiagnosticStatus::ERROR &&
                               status.message.find("1 of 1 plans") == 0) {
                             return true;
                           }
                         }
                         return false;
                       });
  }));
}

/// The launch file asks for one report in 0.1 s.
TEST_F(MpcNodeLiveTest, ReportsOnceInADiagnosticPeriod) {
  ASSERT_TRUE(waitUntil([this] { return diagnostics_.messages.size() >= 11; }));
  const std::vector<diagnostic_msgs::DiagnosticArray>& all = diagnostics_.messages;
  EXPECT_GT((all[10].header.stamp - all[0].header.stamp).toSec(), 0.5);
}

TEST(MpcConfig, HasTheDefaultsAndTheRangesOfTheOptions) {
  const ddm_mpc::MpcConfig start = ddm_mpc::MpcConfig::__getDefault__();
  EXPECT_EQ(start.horizon, MpcOptions().horizon);
  EXPECT_EQ(start.control_weight, MpcOptions().control_weight);
  EXPECT_EQ(start.epsilon, MpcOptions().epsilon);
  const ddm_mpc::MpcConfig min = ddm_mpc::MpcConfig::__getMin__();
  const ddm_mpc::MpcConfig max = ddm_mpc::MpcConfig::__getMax__();
  const auto valid = [](int horizon, double control_weight, double epsilon) {
    MpcOptions options;
    options.horizon = horizon;
    options.control_weight = control_weight;
    options.epsilon = epsilon;
    return options.problems().empty();
  };
  EXPECT_TRUE(valid(min.horizon, min.control_weight, min.epsilon));
  EXPECT_TRUE(valid(max.horizon, 1e300, max.epsilon));
  EXPECT_FALSE(valid(min.horizon - 1, 1.0, 0.5));
  EXPECT_FALSE(valid(max.horizon + 1, 1.0, 0.5));
  EXPECT_FALSE(valid(1, min.control_weight - 1e-9, 0.5));
  EXPECT_FALSE(valid(1, 1.0, min.epsilon - 1e-9));
  EXPECT_FALSE(valid(1, 1.0, max.epsilon + 1e-9));
  EXPECT_EQ(max.control_weight, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace ddm
