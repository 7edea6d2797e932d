// Tests of trials that end during a plan or a preparation, and of a node that ends during a plan.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <vector>

#include "ddm_mpc/cost_to_go.h"
#include "trial_client.h"

namespace ddm {
namespace {

/// The launch file starts a node for two motors with a timeout of 2 s, where a plan takes minutes.
class LongPlan : public MpcNodeTest {
 protected:
  using MpcNodeTest::MpcNodeTest;

  /// Starts a trial with an image that takes minutes to answer.
  void beginPlan(unsigned seed) {
    RandomModelOptions options;
    options.torque_dim = 2;
    options.seed = seed;
    const ddm_msgs::Model model = modelMessage(randomModel(options));
    ddm_msgs::RunTrialGoal goal = trialGoal(2, 0.0, model.id);
    goal.start = client_.publishImage(kSize, 0);
    begin(goal);
    client_.publish(model);
    // Logged right before the plan.
    ASSERT_TRUE(waitUntil([&] { return client_.logged("model " + model.id); }));
  }
};

/// A second node, where such a plan has a budget.
class InTime : public LongPlan {
 protected:
  InTime() : LongPlan("/in_time") {}
};

TEST_F(LongPlan, DoesNotDelayTheAnswerToACancelledGoal) {
  beginPlan(21);
  action_.cancelGoal();
  expectEnd(State::PREEMPTED);
  EXPECT_TRUE(torque_.messages.empty());
  begin(trialGoal(2, 1.0));
  show(2);  // the search has ended with its trial, and the next image is answered
  expectEnd(State::SUCCEEDED);
}

TEST_F(LongPlan, EndsWithTheTimeoutOfItsTrial) {
  beginPlan(22);
  expectEnd(State::ABORTED, {"no plan", "step 1", " 2 s", "mpc/time_budget"});
  EXPECT_TRUE(torque_.messages.empty());
}

TEST_F(InTime, GivesTheBestSoFarWithinItsBudgetAndIsCounted) {
  beginPlan(24);
  show(2);
  expectEnd(State::SUCCEEDED);
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 2; }));
  for (const ddm_msgs::Plan& plan : plan_.messages) {
    EXPECT_EQ(plan.status, ddm_msgs::Plan::TIME_LIMIT);
    EXPECT_GT(plan.evaluations, 1U);
    EXPECT_TRUE(plan.message.empty());
  }
  EXPECT_EQ(action_.getResult()->num_cut_plans, 2U);
  EXPECT_EQ(action_.getResult()->num_failed_plans, 0U);
  for (const ddm_msgs::Torque& torque : torque_.messages) {
    EXPECT_NE(torque.torque, std::vector<double>(2, 0.0));
  }
}

/// A node for three motors, whose cost-to-go takes seconds where a model has the most support states.
class LongPreparation : public MpcNodeTest {
 protected:
  LongPreparation() : MpcNodeTest("/three_motors") {}
};

TEST_F(LongPreparation, DoesNotDelayTheAnswerToACancelledGoal) {
  RandomModelOptions options;
  options.torque_dim = 3;
  options.gain = 0.1;
  const Ddm model = withSupportStates(randomModel(options), 1000);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto begin_of_preparation = now();
  CostToGo(model, Eigen::VectorXd::Constant(3, 6.0)).setGoal(model.goalFeature(), false);
  const auto preparation = now() - begin_of_preparation;

  const ddm_msgs::Model message = modelMessage(model);
  client_.publish(message);
  begin(trialGoal(2, 0.0, message.id));
  ASSERT_TRUE(waitUntil([&] { return client_.logged("model " + message.id); }));
  const auto begin_of_cancelling = now();
  action_.cancelGoal();
  expectEnd(State::PREEMPTED);
  EXPECT_LT(now() - begin_of_cancelling, preparation / 2);
  begin(trialGoal(2, 1.0));
  show(2);  // the preparation that nobody needs has ended
  expectEnd(State::SUCCEEDED);
}

/// Starts a node of its own, where a plan takes minutes.
class InterruptedNode : public LongPlan {
 protected:
  InterruptedNode() : LongPlan("/interrupted") {}

  void SetUp() override {
    ros::param::set("/interrupted/mpc_node/image/size", kSize);
    ros::param::set("/interrupted/mpc_node/controller/torque_dim", 2);
    ros::param::set("/interrupted/mpc_node/mpc/horizon", 200);
    ros::param::set("/interrupted/mpc_node/mpc/num_starts", 1000);
    ros::param::set("/interrupted/mpc_node/mpc/max_iterations", 1000000);
    ros::param::set("/interrupted/mpc_node/mpc/function_tolerance", 0.0);
    node_ = fork();
    ASSERT_GE(node_, 0);
    if (node_ == 0) {
      execl(DDM_MPC_NODE, DDM_MPC_NODE, "__ns:=/interrupted", static_cast<char*>(nullptr));
      _exit(127);
    }
    LongPlan::SetUp();
  }

  void TearDown() override {
    if (node_ > 0 && !exit_status_) {
      kill(node_, SIGKILL);
      waitpid(node_, nullptr, 0);
    }
    ros::param::del("/interrupted");
  }

  bool hasEnded() {
    int status = 0;
    if (!exit_status_ && waitpid(node_, &status, WNOHANG) == node_) exit_status_ = status;
    return exit_status_.has_value();
  }

  pid_t node_ = -1;
  std::optional<int> exit_status_;
};

TEST_F(InterruptedNode, EndsWithoutAnErrorDuringAPlan) {
  beginPlan(23);
  ASSERT_EQ(kill(node_, SIGINT), 0);
  ASSERT_TRUE(waitUntil([this] { return hasEnded(); }));
  EXPECT_EQ(*exit_status_, 0);
}

}  // namespace
}  // namespace ddm
