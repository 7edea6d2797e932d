// What RosWorld hears and how long it waits; the nodes that it talks to are played by this one.
// SPDX-License-Identifier: BSD-3-Clause
#include "ros_world.h"

#include <actionlib/server/simple_action_server.h>
#include <ddm_msgs/Reset.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/StartRecording.h>
#include <ddm_msgs/StopRecording.h>
#include <ddm_msgs/topics.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <future>

namespace ddm {
namespace {

/// Offers what a world without a trainer looks for. In simulated time that stands still, as here,
/// an action tells once that it is there.
class Peers {
 public:
  Peers()
      : server_(
            withQueue(), topics::kRunTrial, [](const ddm_msgs::RunTrialGoalConstPtr&) {},
            /*auto_start=*/false) {
    ros::NodeHandle nh = withQueue();
    reset_ = nh.advertiseService(topics::kReset, &Peers::answer<ddm_msgs::Reset>, this);
    start_ = nh.advertiseService(topics::kStartRecording, &Peers::answerLate, this);
    stop_ =
        nh.advertiseService(topics::kStopRecording, &Peers::answer<ddm_msgs::StopRecording>, this);
    server_.start();
    spinner_.start();
  }

  void release() { release_.set_value(); }

 private:
  ros::NodeHandle withQueue() {
    ros::NodeHandle nh;
    nh.setCallbackQueue(&callbacks_);
    return nh;
  }

  template <class Service>
  bool answer(typename Service::Request& /*request*/, typename Service::Response& /*response*/) {
    return true;
  }
  bool answerLate(ddm_msgs::StartRecording::Request& /*request*/,
                  ddm_msgs::StartRecording::Response& /*response*/) {
    released_.wait();
    return true;
  }

  ros::CallbackQueue callbacks_;
  std::promise<void> release_;
  std::shared_future<void> released_ = release_.get_future().share();
  actionlib::SimpleActionServer<ddm_msgs::RunTrialAction> server_;
  ros::ServiceServer reset_, start_, stop_;
  ros::AsyncSpinner spinner_{2, &callbacks_};
};

TEST(RosWorldTest, DoesNotWaitForTheTimeWithoutEnd) {
  const ros::Time now = ros::Time::now();
  ros::Time::setNow(ros::Time());
  std::string error = "none";
  try {
    RosWorld(ros::NodeHandle(), 0.5, {/*recorder=*/false, /*trainer=*/false});
  } catch (const std::exception& e) {
    error = e.what();
  }
  ros::Time::setNow(now);
  EXPECT_EQ(error, "simulated time does not come (waited 0.5 s), nobody publishes /clock");
}

TEST(RosWorldTest, HearsOfAnActionThatTellsOnceThatItIsThere) {
  const Peers peers;
  EXPECT_NO_THROW(RosWorld(ros::NodeHandle(), 5.0, {/*recorder=*/false, /*trainer=*/false}));
}

TEST(RosWorldTest, NamesAServiceThatDoesNotAnswer) {
  Peers peers;
  RosWorld world(ros::NodeHandle(), 2.0, {/*recorder=*/true, /*trainer=*/false});
  TrialRequest request;
  request.bag = "/nowhere/trial.bag";
  std::string error = "none";
  try {
    world.runTrial(request, [](double) {});
  } catch (const std::exception& e) {
    error = e.what();
  }
  EXPECT_EQ(error, "service /start_recording does not answer (waited 2 s)");
  peers.release();
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::init(argc, argv, "ros_world_test");
  ros::NodeHandle nh;
  ros::Time::setNow(ros::Time(1.0));
  ros::AsyncSpinner spinner(2);  // callbacks of others are handled at any time
  spinner.start();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
