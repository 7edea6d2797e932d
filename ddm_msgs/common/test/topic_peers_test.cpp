// Tests of connections between nodes, of shared topics, and of a stopped master.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/topic_peers.h"

#include <ddm_common/node_watch.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <signal.h>
#include <std_msgs/Float64.h>
#include <xmlrpcpp/XmlRpc.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace ddm {
namespace {

using Lines = std::vector<std::string>;

class TopicPeersTest : public ::testing::Test {
 protected:
  /// Waits until the Python publisher is registered.
  void SetUp() override {
    const Lines expected = {"publisher(s) of /spoken: /alone"};
    ASSERT_EQ(eventually(expected, [] { return Lines{describePublishers("/spoken")}; }), expected);
  }

  /// @return the lines of a function as soon as they equal `expected`, or its last lines after ten
  ///         seconds
  static Lines eventually(const Lines& expected, const std::function<Lines()>& lines) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(10.0);
    Lines last = lines();
    while (last != expected && ros::WallTime::now() < end) {
      ros::WallDuration(0.02).sleep();
      last = lines();
    }
    return last;
  }

  static void listen(const std_msgs::Float64ConstPtr& /*message*/) {}

  ros::NodeHandle nh_;
  ros::Subscriber listener_ = nh_.subscribe<std_msgs::Float64>("/spoken", 1, &listen);
};

TEST_F(TopicPeersTest, ANodeThatDiedBeforeItsProcessCouldBeWatchedIsNoticed) {
  XmlRpc::XmlRpcValue ghost;
  ghost[0] = "/dead";
  ghost[1] = "/last_words";
  ghost[2] = "std_msgs/Float64";
  ghost[3] = "http://localhost:1/";  // no process listens at port 1
  ASSERT_TRUE(askMaster("registerPublisher", ghost).has_value());
  NodeWatch watch;
  watch.hear("/dead");
  EXPECT_EQ(eventually({"died"}, [&watch] { return Lines{watch.died() ? "died" : "lives"}; }),
            Lines{"died"});
  watch.hear("/alone");
  EXPECT_FALSE(watch.died());
  XmlRpc::XmlRpcValue leaving;
  leaving[0] = ghost[0];
  leaving[1] = ghost[1];
  leaving[2] = ghost[3];
  ASSERT_TRUE(askMaster("unregisterPublisher", leaving).has_value());
}

TEST_F(TopicPeersTest, APublisherInPythonIsFoundToBeConnected) {
  EXPECT_EQ(eventually({}, [] { return missingConnections({"/spoken"}); }), Lines());
}

TEST_F(TopicPeersTest, ASubscriberWithoutAConnectionIsNamed) {
  XmlRpc::XmlRpcValue ghost;
  ghost[0] = "/ghost";
  ghost[1] = "/spoken";
  ghost[2] = "std_msgs/Float64";
  ghost[3] = "http://localhost:1/";  // no process listens at port 1
  ASSERT_TRUE(askMaster("registerSubscriber", ghost).has_value());
  const Lines expected = {"/alone -> /ghost on /spoken"};
  EXPECT_EQ(eventually(expected, [] { return missingConnections({"/spoken"}); }), expected);
  ghost[2] = ghost[3];
  XmlRpc::XmlRpcValue gone;
  for (int i = 0; i < 3; ++i) gone[i] = ghost[i];
  ASSERT_TRUE(askMaster("unregisterSubscriber", gone).has_value());
}

TEST_F(TopicPeersTest, ATopicWithTwoPublishersIsNamedUnlessOneOfThemIsThisNode) {
  const ros::Publisher own = nh_.advertise<std_msgs::Float64>("/spoken", 1);
  const Lines expected = {"/disputed: /first, /second"};
  EXPECT_EQ(eventually(expected, [] { return sharedTopics({"/disputed", "/spoken"}); }), expected);
}

/// XML-RPC method that answers every request for connections with numbers.
class Babbler : public XmlRpc::XmlRpcServerMethod {
 public:
  explicit Babbler(XmlRpc::XmlRpcServer* server) : XmlRpcServerMethod("getBusInfo", server) {}
  void execute(XmlRpc::XmlRpcValue& /*request*/, XmlRpc::XmlRpcValue& answer) override {
    answer[0] = 1;
    answer[1] = "";
    for (int i = 0; i < 5; ++i) answer[2][0][i] = i;
  }
};

TEST_F(TopicPeersTest, ANodeThatAnswersWithOtherTypesIsNamed) {
  XmlRpc::XmlRpcServer server;
  Babbler babbler(&server);
  ASSERT_TRUE(server.bindAndListen(0));
  std::atomic<bool> ended{false};
  std::thread work([&] {
    while (!ended) server.work(0.05);
  });
  XmlRpc::XmlRpcValue node;
  node[0] = "/babbler";
  node[1] = "/spoken";
  node[2] = "std_msgs/Float64";
  node[3] = "http://localhost:" + std::to_string(server.get_port()) + "/";
  EXPECT_TRUE(askMaster("registerPublisher", node).has_value());
  const Lines expected = {"/babbler -> " + ros::this_node::getName() + " on /spoken"};
  EXPECT_EQ(eventually(expected, [] { return missingConnections({"/spoken"}); }), expected);
  XmlRpc::XmlRpcValue gone;
  gone[0] = node[0];
  gone[1] = node[1];
  gone[2] = node[3];
  EXPECT_TRUE(askMaster("unregisterPublisher", gone).has_value());
  ended = true;
  work.join();
}

TEST_F(TopicPeersTest, AMasterThatWasStoppedIsNotWaitedForWithoutEnd) {
  const auto pid = askMaster("getPid", ros::this_node::getName());
  ASSERT_TRUE(pid.has_value());
  XmlRpc::XmlRpcValue number = *pid;
  ASSERT_EQ(::kill(static_cast<int>(number), SIGSTOP), 0);
  // The signal takes a moment to stop all threads of the master.
  const Lines expected = {"master"};
  const Lines missing = eventually(expected, [&expected] {
    const Lines lines = missingConnections({"/spoken"});
    const bool named = lines.size() == 1 && lines[0].find(expected[0]) != std::string::npos;
    return named ? expected : lines;
  });
  ::kill(static_cast<int>(number), SIGCONT);
  EXPECT_EQ(missing, expected);
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::init(argc, argv, "topic_peers_test");
  ros::NodeHandle nh;
  ros::AsyncSpinner spinner(1);
  spinner.start();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
