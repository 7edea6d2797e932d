// Tests of RosDriver: what it receives and how long it waits. This program plays the nodes.
// SPDX-License-Identifier: BSD-3-Clause
#include "ros_driver.h"

#include <actionlib/server/simple_action_server.h>
#include <ddm_common/waiting.h>
#include <ddm_msgs/Reset.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/StartRecording.h>
#include <ddm_msgs/StopRecording.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/topics.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace ddm {
namespace {

constexpr int kSteps = 2;

/// Offers the services and actions that a driver without a trainer needs. In these tests, simulated
/// time stands still, so that an action publishes its status only once.
class Peers {
 public:
  Peers()
      : server_(
            withQueue(), topics::kRunTrial,
            [this](const ddm_msgs::RunTrialGoalConstPtr&) { runTrial(); }, /*auto_start=*/false) {
    ros::NodeHandle nh = withQueue();
    reset_ = nh.advertiseService(topics::kReset, &Peers::onReset, this);
    start_ = nh.advertiseService(topics::kStartRecording, &Peers::onStart, this);
    stop_ =
        nh.advertiseService(topics::kStopRecording, &Peers::answer<ddm_msgs::StopRecording>, this);
    server_.start();
    spinner_.start();
  }
  ~Peers() { release(); }

  /// Sets the time that each service takes to answer [s]. release() ends this time early.
  void answerAfter(double seconds) { answer_time_ = seconds; }

  /// Makes the trial continue, with feedback and ground truth, until release() is called.
  void runUntilReleased() {
    endless_ = true;
    truth_ = ros::NodeHandle().advertise<sensor_msgs::JointState>(topics::kGroundTruth, 0);
  }

  /// Stops the publisher of ground truth before the trial ends.
  /// @param tell  whether the ground truth is published before
  void leaveEarly(bool tell) {
    truth_ = ros::NodeHandle().advertise<sensor_msgs::JointState>(topics::kGroundTruth, 0);
    heard_ = withQueue().subscribe<sensor_msgs::JointState>(
        topics::kGroundTruth, 0, [this](const sensor_msgs::JointStateConstPtr&) { ++num_heard_; });
    tells_ = tell;
    leaves_ = true;
  }

  std::uint32_t numTruths() const { return num_truths_; }

  /// Sets the stamps of the first and the last image of the following trials [s].
  void showImages(double first, double last) {
    const std::lock_guard<std::mutex> lock(mutex_);
    first_ = ros::Time(first);
    last_ = ros::Time(last);
  }

  /// `path` and `after` [s] of all calls of start_recording.
  std::vector<std::pair<std::string, double>> recordings() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return recordings_;
  }

  void release() {
    if (!released_.exchange(true)) release_.set_value();
  }

 private:
  ros::NodeHandle withQueue() {
    ros::NodeHandle nh;
    nh.setCallbackQueue(&callbacks_);
    return nh;
  }

  bool onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      response.start = first_;
    }
    return answer<ddm_msgs::Reset>(request, response);
  }

  bool onStart(ddm_msgs::StartRecording::Request& request,
               ddm_msgs::StartRecording::Response& response) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      recordings_.emplace_back(request.path, request.after.toSec());
    }
    return answer<ddm_msgs::StartRecording>(request, response);
  }

  template <class Service>
  bool answer(typename Service::Request& /*request*/, typename Service::Response& response) {
    end_.wait_for(std::chrono::duration<double>(answer_time_));
    response.success = true;
    return true;
  }

  void runTrial() {
    ddm_msgs::RunTrialFeedback feedback;
    do {
      feedback.step = 1;
      server_.publishFeedback(feedback);
      for (int i = 0; truth_ && tells_ && i < 50; ++i) truth_.publish(nextTruth());
    } while (endless_ && end_.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready);
    ddm_msgs::RunTrialResult result;
    result.num_steps = kSteps;
    result.exploratory.resize(kSteps);
    result.stamp.resize(kSteps);
    // A subscriber receives messages some time after they were published.
    while (leaves_ && tells_ && num_heard_ < kSteps) std::this_thread::yield();
    if (leaves_) truth_.shutdown();
    for (std::uint32_t i = 0; (truth_ || leaves_) && i < result.stamp.size(); ++i)
      result.stamp[i] = stampOf(i);
    result.torque.resize(kSteps);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      result.last = last_;
    }
    server_.setSucceeded(result);
  }

  static ros::Time stampOf(std::uint32_t truth) { return ros::Time(2, 1000 * truth); }

  sensor_msgs::JointState nextTruth() {
    sensor_msgs::JointState joints;
    joints.header.stamp = stampOf(num_truths_++);
    joints.position = {0.5};
    return joints;
  }

  ros::CallbackQueue callbacks_;
  ros::Publisher truth_;
  std::atomic<std::uint32_t> num_truths_{0};
  ros::Subscriber heard_;
  std::atomic<int> num_heard_{0};
  std::atomic<double> answer_time_{0.0};
  std::atomic<bool> endless_{false};
  std::atomic<bool> tells_{true};
  std::atomic<bool> leaves_{false};
  std::atomic<bool> released_{false};
  mutable std::mutex mutex_;  // guards the next three members
  ros::Time first_, last_;
  std::vector<std::pair<std::string, double>> recordings_;
  std::promise<void> release_;
  std::shared_future<void> end_ = release_.get_future().share();
  actionlib::SimpleActionServer<ddm_msgs::RunTrialAction> server_;
  ros::ServiceServer reset_, start_, stop_;
  ros::AsyncSpinner spinner_{2, &callbacks_};
};

TrialRequest trial() {
  TrialRequest request;
  request.num_steps = kSteps;
  return request;
}

/// Runs a trial and returns its error message.
std::string errorOf(RosDriver* driver, const TrialRequest& request) {
  try {
    driver->runTrial(request, [](double) {});
  } catch (const std::exception& e) {
    return e.what();
  }
  return "none";
}

TEST(RosDriverTest, DoesNotWaitForTheTimeWithoutEnd) {
  const ros::Time now = ros::Time::now();
  ros::Time::setNow(ros::Time());
  EXPECT_TRUE(testing::throwsNaming<std::runtime_error>(
      [] {
        RosDriver(ros::NodeHandle(), 0.5, {/*recorder=*/false, /*trainer=*/false});
      },
      {"0.5 s", "nobody", "/clock"}));
  ros::Time::setNow(now);
}

TEST(RosDriverTest, HearsOfAnActionThatTellsOnceThatItIsThere) {
  const Peers peers;
  EXPECT_NO_THROW(RosDriver(ros::NodeHandle(), 5.0, {/*recorder=*/false, /*trainer=*/false}));
}

TEST(RosDriverTest, NamesAServiceThatDoesNotAnswer) {
  Peers peers;
  peers.answerAfter(60.0);
  RosDriver driver(ros::NodeHandle(), 1.0, {/*recorder=*/true, /*trainer=*/false});
  TrialRequest request = trial();
  request.bag = "/nowhere/trial.bag";
  EXPECT_TRUE(testing::names(errorOf(&driver, request), {"/start_recording", "answer", " 1 s"}));
}

TEST(RosDriverTest, ConnectsAgainAfterAServiceThatDidNotAnswer) {
  Peers peers;
  peers.answerAfter(3.0);
  RosDriver driver(ros::NodeHandle(), 1.0, {/*recorder=*/false, /*trainer=*/false});
  EXPECT_NE(errorOf(&driver, trial()), "none");
  peers.answerAfter(0.0);
  EXPECT_EQ(errorOf(&driver, trial()), "none");
}

TEST(RosDriverTest, LeavesARobotTheTimeThatItsResetMayTake) {
  Peers peers;
  peers.answerAfter(2.5);
  RosDriver driver(ros::NodeHandle(), 1.0, {/*recorder=*/false, /*trainer=*/false, 10.0});
  EXPECT_EQ(errorOf(&driver, trial()), "none");
}

TEST(RosDriverTest, HasATrialRecordedThatBeginsEarlierThanTheLastOneEnded) {
  Peers peers;
  RosDriver driver(ros::NodeHandle(), 5.0, {/*recorder=*/true, /*trainer=*/false});
  TrialRequest request = trial();
  request.bag = "/nowhere/trial.bag";
  const auto runFrom = [&](double first) {
    peers.showImages(first, first + 10.0);
    EXPECT_EQ(errorOf(&driver, request), "none");
  };
  runFrom(100.0);
  runFrom(120.0);
  runFrom(70.0);  // the clock has been set back
  runFrom(90.0);
  const std::vector<std::pair<std::string, double>> expected = {{request.bag, 0.0},
                                                                {request.bag, 110.0},
                                                                {request.bag, 130.0},
                                                                {"", 0.0},
                                                                {request.bag, 80.0}};
  EXPECT_EQ(peers.recordings(), expected);
}

/// If a terminal is suspended, writing to it blocks. Only the thread that reports progress may
/// block.
TEST(RosDriverTest, HearsItsPeersWhileItsProgressIsHeldUp) {
  Peers peers;
  peers.runUntilReleased();
  RosDriver driver(ros::NodeHandle(), 1.0, {/*recorder=*/false, /*trainer=*/false});
  std::set<std::thread::id> reporters;
  const TrialOutcome outcome = driver.runTrial(trial(), [&](double) {
    if (reporters.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    reporters.insert(std::this_thread::get_id());
    peers.release();
  });
  EXPECT_EQ(reporters, std::set<std::thread::id>{std::this_thread::get_id()});
  EXPECT_GT(peers.numTruths(), 2000u);  // more than a queue of fixed length would hold
  EXPECT_EQ(outcome.states.size(), static_cast<size_t>(kSteps));
}

TEST(RosDriverTest, DoesNotDoWithoutTheGroundTruthOfASimulatorThatLeavesEarly) {
  for (const bool tells : {true, false}) {
    Peers peers;
    peers.leaveEarly(tells);
    RosDriver driver(ros::NodeHandle(), 1.0, {/*recorder=*/false, /*trainer=*/false});
    if (tells) {
      EXPECT_EQ(driver.runTrial(trial(), [](double) {}).states.size(), size_t{kSteps});
    } else {
      EXPECT_TRUE(testing::names(errorOf(&driver, trial()), {"ground truth", "incomplete"}));
    }
  }
}

/// Copies of a client share one connection. A call that gives up must not close the connection
/// while another call uses it.
TEST(ServiceCall, LeavesTheConnectionToTheCallThatIsUnderWay) {
  Peers peers;
  peers.answerAfter(60.0);
  ros::ServiceClient client =
      ros::NodeHandle().serviceClient<ddm_msgs::Reset>(topics::kReset, /*persistent=*/true);
  const ros::ServiceClient under_way = client;
  ddm_msgs::Reset service;
  EXPECT_TRUE(testing::throwsNaming<std::runtime_error>(
      [&] { callService("/reset", &client, &service, 0.5); }, {"/reset", "0.5 s"}));
  EXPECT_TRUE(under_way.isValid());
  EXPECT_FALSE(client.isValid());
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::init(argc, argv, "ros_driver_test");
  ros::NodeHandle nh;
  ros::Time::setNow(ros::Time(1.0));
  ros::AsyncSpinner spinner(2);  // callbacks of the peers run at any time
  spinner.start();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
