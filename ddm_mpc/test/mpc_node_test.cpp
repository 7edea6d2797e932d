// Tests of mpc_node from outside: trials, models, and what it does when something is missing.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>

#include "trial_client.h"

namespace ddm {
namespace {

TEST_F(MpcNodeTest, AnswersEachImageOfARandomTrialWithATorqueOfItsStamp) {
  begin(trialGoal(20, /*epsilon=*/1.0));
  show(20);
  expectEnd(State::SUCCEEDED);
  ASSERT_EQ(torque_.messages.size(), 20U);
  const ddm_msgs::RunTrialResult result = *action_.getResult();
  for (std::size_t step = 0; step < 20; ++step) {
    EXPECT_EQ(torque_.messages[step].header.stamp, stamps_[step]);
    EXPECT_TRUE(torque_.messages[step].exploratory);
    ASSERT_EQ(torque_.messages[step].torque.size(), 1U);
    EXPECT_LE(std::abs(torque_.messages[step].torque[0]), 6.0);
    EXPECT_EQ(result.torque[step], torque_.messages[step].torque[0]);
  }
  EXPECT_EQ(result.num_steps, 20U);
  EXPECT_EQ(result.num_exploratory, 20U);
  EXPECT_TRUE(result.solve_time.empty());
}

TEST_F(MpcNodeTest, WaitsForTheModelOfTheGoalAndThenPlans) {
  const ddm_msgs::Model model = modelOfSeed(11);
  ddm_msgs::RunTrialGoal goal = trialGoal(4, /*epsilon=*/0.0, model.id);
  // The first image is there before goal and model are, as in lock-step; it is answered all the
  // same.
  stamps_.push_back(client_.publishImage(kSize, 0));
  goal.start = stamps_[0];
  begin(goal);
  EXPECT_EQ(action_.getState(), State::ACTIVE);
  EXPECT_TRUE(torque_.messages.empty());
  client_.publish(model);
  ASSERT_TRUE(waitUntil([this] { return torque_.messages.size() == 1; }));
  show(4);
  expectEnd(State::SUCCEEDED);
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 4; }));
  for (std::size_t step = 0; step < 4; ++step) {
    const ddm_msgs::Plan& plan = plan_.messages[step];
    EXPECT_EQ(torque_.messages[step].header.stamp, stamps_[step]);
    EXPECT_EQ(plan.header.stamp, stamps_[step]);
    EXPECT_FALSE(torque_.messages[step].exploratory);
    EXPECT_NE(plan.status, ddm_msgs::Plan::FAILED);
    EXPECT_EQ(plan.horizon, 15U);
    ASSERT_EQ(plan.torque.size(), 15U);
    EXPECT_EQ(plan.feature.size(), 32U);
    EXPECT_EQ(plan.goal_feature.size(), 2U);
    EXPECT_EQ(plan.torque[0], torque_.messages[step].torque[0]);
    EXPECT_GT(plan.solve_time, 0.0);
  }
  EXPECT_EQ(action_.getResult()->solve_time.size(), 4U);
}

/// A plant that says which torque acted after each image.
class MpcNodeOfAPlantTest : public MpcNodeTest {
 protected:
  void SetUp() override {
    MpcNodeTest::SetUp();
    ASSERT_TRUE(waitUntil([this] { return applied_.getNumSubscribers() > 0; }));
  }

  /// A greedy trial of two images.
  /// @param applied  by the last torque instead of what was decided; empty: what was decided
  /// @param wait     before the second image, more than the time step [s]
  /// @return         torque that answers the second image
  double secondTorque(const std::vector<double>& applied, bool nothing_acts, double wait) {
    const ddm_msgs::Model model = modelOfSeed(11);
    client_.publish(model);
    torque_.messages.clear();
    ddm_msgs::RunTrialGoal goal = trialGoal(3, 0.0, model.id);
    goal.start = client_.publishImage(kSize, 0);  // answered once, whatever comes first
    begin(goal);
    EXPECT_TRUE(waitUntil([this] { return torque_.messages.size() == 1; }));
    for (std::size_t step = 1; step < 3; ++step) {
      ddm_msgs::Torque message = torque_.messages.back();
      if (step == 2 && !applied.empty()) message.torque = applied;
      if (step == 2 && nothing_acts) message.torque.clear();
      applied_.publish(message);
      if (step == 2) client_.passTime(wait);
      client_.publishImage(kSize, step);
      EXPECT_TRUE(waitUntil([&] { return torque_.messages.size() > step; }));
    }
    expectEnd(State::SUCCEEDED);
    applied_.publish(torque_.messages.back());  // which must not delay those of the next trial
    return torque_.messages.back().torque.at(0);
  }

  ros::Publisher applied_ = client_.nh.advertise<ddm_msgs::Torque>(topics::kAppliedTorque, 10);
};

TEST_F(MpcNodeOfAPlantTest, TakesWhatActedAndWhatWasNotSeenIntoItsState) {
  const double usual = secondTorque({}, false, 0.0);
  EXPECT_EQ(secondTorque({}, false, 0.0), usual);
  EXPECT_NE(secondTorque({4.0}, false, 0.0), usual);
  const double anew = secondTorque({}, true, 0.0);
  EXPECT_NE(anew, usual) << "no torque acted";
  EXPECT_EQ(secondTorque({}, false, 0.2), anew) << "an image is missing";
  EXPECT_EQ(secondTorque({}, false, 0.05), usual) << "an image is a little late";
}

TEST_F(MpcNodeTest, PublishesZeroTorqueAndSaysSoWhereThePlanFails) {
  RandomModelOptions options;
  options.gain = 1e200;
  const ddm_msgs::Model model = modelMessage(randomModel(options));
  client_.publish(model);
  begin(trialGoal(2, 0.0, model.id));
  ASSERT_TRUE(waitUntil([this] {  // the goal may have come before the model
    if (torque_.messages.empty()) client_.publishImage(kSize, 0);
    return !torque_.messages.empty();
  }));
  show(2);
  expectEnd(State::SUCCEEDED);
  EXPECT_EQ(action_.getResult()->num_failed_plans, 2U);
  EXPECT_EQ(torque_.messages[1].torque, std::vector<double>{0.0});
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 2; }));
  EXPECT_EQ(plan_.messages[1].status, ddm_msgs::Plan::FAILED);
  EXPECT_FALSE(plan_.messages[1].message.empty());
}

TEST_F(MpcNodeTest, AnswersAnImageOnlyOnceAndNoneFromBeforeTheStartAndNamesTheSilentCamera) {
  ddm_msgs::RunTrialGoal goal = trialGoal(2, 1.0);
  goal.start = ros::Time(
      2000.0);  // later than all images of other tests, the last of which the node remembers
  begin(goal);
  const ros::Time before = goal.start - ros::Duration(1.0);
  client_.publish(encodeImage(randomImage(kSize, 1), kSize, before, ""));
  const sensor_msgs::Image image = encodeImage(randomImage(kSize, 1), kSize, goal.start, "");
  ASSERT_TRUE(waitUntil([&] {  // of images that come at once the node takes the newest alone
    client_.publish(image);
    return torque_.messages.size() == 1;
  }));
  client_.publish(image);
  expectEnd(State::ABORTED,
            {"no image", "step 1", " 3 s", "/camera/image_raw", ros::this_node::getName()});
  EXPECT_EQ(action_.getResult()->num_steps, 1U);
  ASSERT_EQ(torque_.messages.size(), 1u);
  EXPECT_EQ(torque_.messages[0].header.stamp, goal.start);
}

TEST_F(MpcNodeTest, AbortsWithZeroTorqueWhenTheImagesChangeTheirSize) {
  begin(trialGoal(10, 1.0));
  show(3);
  const ros::Time stamp = client_.publishImage(kSize + 1, 1);
  expectEnd(State::ABORTED, {"image refused", "8x8 mono8", "9x9 mono8"});
  ASSERT_TRUE(waitUntil([this] { return torque_.messages.size() == 4; }));
  EXPECT_EQ(torque_.messages[3].header.stamp, stamp);
  EXPECT_EQ(torque_.messages[3].torque, std::vector<double>{0.0});
  EXPECT_EQ(action_.getResult()->num_steps, 3U);
}

TEST_F(MpcNodeTest, AbortsAtAnImageThatHasNoStamp) {
  begin(trialGoal(10, 1.0));
  client_.publish(encodeImage(randomImage(kSize, 1), kSize, ros::Time(), ""));
  expectEnd(State::ABORTED, {"no stamp"});
}

TEST_F(MpcNodeTest, RefusesTrialsThatCannotBeRun) {
  RandomModelOptions options;
  options.image_size = kSize + 2;
  const ddm_msgs::Model large = modelMessage(randomModel(options));
  client_.publish(large);
  begin(trialGoal(10, 0.0));
  expectEnd(State::ABORTED, {"trial refused", "epsilon < 1", "model"});
  begin(trialGoal(0, 1.0));
  expectEnd(State::ABORTED, {"num_steps", ">= 1"});
  begin(trialGoal(10, 0.0, large.id));
  expectEnd(State::ABORTED, {"size 10", "image/size 8"});
}

TEST_F(MpcNodeTest, NamesTheModelOrTheGoalImageThatDoesNotCome) {
  begin(trialGoal(10, 0.0, "0badc0de"));
  expectEnd(State::ABORTED, {"model 0badc0de", " 3 s", "/model"});
  ddm_msgs::RunTrialGoal goal = trialGoal(10, /*epsilon=*/1.0);
  goal.goal = ros::Time(499.0);
  begin(goal);
  expectEnd(State::ABORTED, {"goal image", " 3 s", "/goal_image"});
}

TEST_F(MpcNodeTest, WaitsForTheGoalImageOfTheTrialAndTakesNewerOnes) {
  RandomModelOptions options;
  const Ddm model = randomModel(options);
  const auto isOf = [&model](unsigned seed, const ddm_msgs::Plan& plan) {
    const Eigen::VectorXd z = model.encode(randomImage(kSize, seed));
    return plan.goal_feature == std::vector<double>(z.data(), z.data() + z.size());
  };
  ASSERT_TRUE(waitUntil([this] { return client_.goalImageIsHeard(); }));
  client_.publish(modelMessage(model));
  client_.publishGoalImage(kSize, 20, ros::Time(500.0));  // of an earlier trial
  ddm_msgs::RunTrialGoal goal = trialGoal(1000, /*epsilon=*/0.0, modelMessage(model).id);
  stamps_.push_back(client_.publishImage(kSize, 0));
  goal.start = stamps_[0];
  goal.goal = ros::Time(501.0);
  begin(goal);
  EXPECT_TRUE(torque_.messages.empty());
  client_.publishGoalImage(kSize, 21, goal.goal);
  ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == 1; }));
  EXPECT_TRUE(isOf(21, plan_.messages[0]));
  client_.publishGoalImage(kSize, 22, ros::Time(502.0));
  for (int image = 0; image < 500 && !isOf(22, plan_.messages.back()); ++image) {
    show(torque_.messages.size() + 1);
    ASSERT_TRUE(waitUntil([this] { return plan_.messages.size() == torque_.messages.size(); }));
  }
  EXPECT_TRUE(isOf(22, plan_.messages.back()));
  action_.cancelGoal();
  expectEnd(State::PREEMPTED);
}

TEST_F(MpcNodeTest, StartsFromTheFirstStepWhenANewGoalReplacesATrial) {
  begin(trialGoal(10, 1.0));
  show(3);
  torque_.messages.clear();
  begin(trialGoal(4, 1.0));
  ASSERT_TRUE(waitUntil([this] { return action_.getState() == State::ACTIVE; }));
  show(4);
  expectEnd(State::SUCCEEDED);
  EXPECT_EQ(action_.getResult()->num_steps, 4U);
}

TEST_F(MpcNodeTest, RefusesADamagedModelAndKeepsTheLastOne) {
  const ddm_msgs::Model model = modelOfSeed(12);
  ddm_msgs::RunTrialGoal goal = trialGoal(1, 0.0, model.id);
  goal.start = client_.publishImage(kSize, 0);
  client_.publish(model);
  begin(goal);
  expectEnd(State::SUCCEEDED);
  EXPECT_TRUE(waitUntil([this] {
    client_.publish(damagedModelMessage());
    return client_.logged("model refused") && client_.logged("wrong checksum");
  }));
  torque_.messages.clear();
  begin(trialGoal(1, 0.0, model.id));
  show(1);
  expectEnd(State::SUCCEEDED);
}

}  // namespace
}  // namespace ddm
