// Tests of model_node: the action `train` and the latched topic `model`.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib/client/simple_action_client.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/TrainAction.h>
#include <ddm_msgs/testing/node_main.h>
#include <ddm_msgs/topics.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <ros/topic.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>

#include "ddm_model/model_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/run_program.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "toy_bags.h"

namespace ddm {
namespace {

using Client = actionlib::SimpleActionClient<ddm_msgs::TrainAction>;
using State = actionlib::SimpleClientGoalState;
using diagnostic_msgs::DiagnosticStatus;
using testing::contains;

const ros::Duration kLimit(20.0);

class ModelNodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    testing::writeTrial(folder_.file("a.bag"), testing::toyTrial(30, 1));
    testing::writeTrial(folder_.file("b.bag"), testing::toyTrial(30, 2));
    ASSERT_TRUE(client_.waitForServer(kLimit));
  }

  ddm_msgs::TrainGoal goal(const std::vector<std::string>& bags, std::uint64_t seed = 1) const {
    ddm_msgs::TrainGoal goal;
    for (const std::string& bag : bags) goal.bags.push_back(folder_.file(bag));
    goal.seed = seed;
    goal.trial = 4;
    return goal;
  }

  ModelNodeTest() {
    diagnostics_ = nh_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
          for (const DiagnosticStatus& status : array->status) statuses_[status.name] = status;
        });
  }

  /// A model_node reports a status of this level with these words.
  ::testing::AssertionResult reports(const std::string& node, std::uint8_t level,
                                     const std::string& words) {
    const DiagnosticStatus& status = statuses_[node + ": training"];
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kLimit.toSec());
    while (ros::WallTime::now() < end) {
      if (status.level == level && contains(status.message, words)) {
        return ::testing::AssertionSuccess();
      }
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    }
    return ::testing::AssertionFailure() << "it is: " << status.message;
  }

  ros::NodeHandle nh_;
  ros::Subscriber diagnostics_;
  std::map<std::string, DiagnosticStatus> statuses_;  ///< the latest of each name
  const testing::TempFolder folder_;
  Client client_{topics::kTrain, /*spin_thread=*/true};
};

TEST_F(ModelNodeTest, TrainsAndPublishesTheWholeModelLatched) {
  ASSERT_EQ(client_.sendGoalAndWait(goal({"a.bag", "b.bag"}), kLimit), State::SUCCEEDED);
  const auto result = client_.getResult();
  // Subscribes after it was published.
  const auto message = ros::topic::waitForMessage<ddm_msgs::Model>(topics::kModel, kLimit);
  ASSERT_TRUE(message);
  const std::string bytes(message->data.begin(), message->data.end());
  EXPECT_EQ(message->id, modelId(bytes));
  EXPECT_EQ(message->id, result->model.id);
  const Ddm model = deserialiseModel(bytes, "topic model");
  EXPECT_EQ(model.info().frames, 60U);
  EXPECT_EQ(model.goal(), testing::toyImage(3.0));
  EXPECT_EQ(message->frames, 60U);
  EXPECT_EQ(message->seed, 1U);
  EXPECT_EQ(message->trial, 4U);
  EXPECT_EQ(message->image_size, 8U);
  EXPECT_EQ(message->feature_dim, 2U);
  EXPECT_EQ(message->torque_dim, 1U);
  EXPECT_EQ(message->order, 2U);
  EXPECT_EQ(message->v_r, model.info().v_r);
  EXPECT_EQ(message->v_p, model.info().v_p);
  EXPECT_EQ(message->config_hash, checksum(model.info().config));
  EXPECT_EQ(result->model.data, message->data);
  EXPECT_GT(result->evaluations, 0U);
  EXPECT_GT(result->train_time, 0.0);
  EXPECT_TRUE(reports("model_node", DiagnosticStatus::OK, "trial 4: trained"));
}

TEST_F(ModelNodeTest, AbortsNamingABadBagAndGoesOn) {
  std::ofstream(folder_.file("text.bag")) << "no bag at all\n";
  for (const char* bad : {"missing.bag", "text.bag", "b.bag.active"}) {
    EXPECT_EQ(client_.sendGoalAndWait(goal({"a.bag", bad}), kLimit), State::ABORTED) << bad;
    EXPECT_TRUE(contains(client_.getState().getText(), folder_.file(bad)))
        << client_.getState().getText();
  }
  EXPECT_TRUE(reports("model_node", DiagnosticStatus::ERROR, folder_.file("b.bag.active")));
  EXPECT_EQ(client_.sendGoalAndWait(goal({"a.bag"}), kLimit), State::SUCCEEDED);
}

TEST_F(ModelNodeTest, TellsItsProgressAndCanBePreempted) {
  testing::writeTrial(folder_.file("long.bag"), testing::toyTrial(300, 1, 24));
  Client slow("slow/train", /*spin_thread=*/true);
  ASSERT_TRUE(slow.waitForServer(kLimit));
  std::mutex mutex;
  std::condition_variable arrived;
  ddm_msgs::TrainFeedback latest;
  bool any = false;
  slow.sendGoal(goal({"long.bag"}), Client::SimpleDoneCallback(), Client::SimpleActiveCallback(),
                [&](const ddm_msgs::TrainFeedbackConstPtr& feedback) {
                  const std::lock_guard<std::mutex> lock(mutex);
                  latest = *feedback;
                  any = feedback->v_r > 0.0;  // not yet while bags are read
                  arrived.notify_all();
                });
  {
    std::unique_lock<std::mutex> lock(mutex);
    ASSERT_TRUE(arrived.wait_for(lock, std::chrono::seconds(20), [&] { return any; }));
    EXPECT_GT(latest.v_r, 0.0);
    EXPECT_GT(latest.v_p, 0.0);
    EXPECT_GT(latest.gradient_norm, 0.0);
    EXPECT_GE(latest.fraction_done, 0.0);
    EXPECT_LE(latest.fraction_done, 1.0);
  }
  EXPECT_TRUE(reports("slow/model_node", DiagnosticStatus::OK, "trial 4: training, 0 %"));
  slow.cancelGoal();
  ASSERT_TRUE(slow.waitForResult(kLimit));
  EXPECT_EQ(slow.getState(), State::PREEMPTED);
  EXPECT_EQ(slow.getResult()->model.id, "");
  EXPECT_TRUE(reports("slow/model_node", DiagnosticStatus::WARN, "trial 4: training cancelled"));
}

TEST_F(ModelNodeTest, ATrainingThatFailsTellsWhyAndCanBePreemptedWhileItReadsBags) {
  testing::writeTrial(folder_.file("long.bag"), testing::toyTrial(300, 1, 24));
  Client failing("failing/train", /*spin_thread=*/true);
  ASSERT_TRUE(failing.waitForServer(kLimit));
  EXPECT_EQ(failing.sendGoalAndWait(goal({"long.bag"}), kLimit), State::ABORTED);
  EXPECT_TRUE(testing::names(failing.getState().getText(),
                             {"objective: stage 1 of 1 stays at ", "evaluated", "block training"}));
  EXPECT_TRUE(reports("failing/model_node", DiagnosticStatus::ERROR, "objective"));
  std::vector<std::string> many;
  for (int i = 0; i < 400; ++i) {
    many.push_back(std::to_string(i) + ".bag");
    std::filesystem::copy_file(folder_.file("long.bag"), folder_.file(many.back()));
  }
  failing.sendGoal(goal(many), Client::SimpleDoneCallback(), [&failing] { failing.cancelGoal(); });
  ASSERT_TRUE(failing.waitForResult(kLimit));
  EXPECT_EQ(failing.getState(), State::PREEMPTED) << failing.getState().getText();
}

TEST(ModelNodeParams, RefusesToStartWithParametersThatAreWrong) {
  ros::param::set("/bad_node/training/max_iteratoins", 3);
  ros::param::set("/bad_node/model/order", 0);
  const testing::Outcome outcome =
      testing::run("timeout 20 " DDM_MODEL_NODE " __name:=bad_node 2>&1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(
      testing::names(outcome.out, {"training/max_iteratoins", "model/order", "[1, 50]", "got 0"}));
}

}  // namespace
}  // namespace ddm
