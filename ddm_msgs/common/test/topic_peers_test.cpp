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

/// A node that the master knows, and that is nowhere else. Its type is Float64.
class Registration {
 public:
  /// @param role  Publisher or Subscriber
  Registration(const std::string& role, const std::string& node, const std::string& topic,
               const std::string& uri = "http://localhost:1/")  // no process listens at port 1
      : role_(role) {
    XmlRpc::XmlRpcValue entry;
    entry[0] = entry_[0] = node;
    entry[1] = entry_[1] = topic;
    entry[2] = "std_msgs/Float64";
    entry[3] = entry_[2] = uri;
    EXPECT_TRUE(askMaster("register" + role_, entry).has_value());
  }
  ~Registration() { EXPECT_TRUE(askMaster("unregister" + role_, entry_).has_value()); }
  Registration(const Registration&) = delete;

 private:
  const std::string role_;
  XmlRpc::XmlRpcValue entry_;  ///< without the type
};

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
  const Registration ghost("Publisher", "/dead", "/last_words");
  NodeWatch watch;
  watch.hear("/dead");
  EXPECT_EQ(eventually({"died"}, [&watch] { return Lines{watch.died() ? "died" : "lives"}; }),
            Lines{"died"});
  watch.hear("/alone");
  EXPECT_FALSE(watch.died());
}

TEST_F(TopicPeersTest, APublisherInPythonIsFoundToBeConnected) {
  EXPECT_EQ(eventually({}, [] { return missingConnections({"/spoken"}); }), Lines());
}

TEST_F(TopicPeersTest, ASubscriberWithoutAConnectionIsNamed) {
  const Registration ghost("Subscriber", "/ghost", "/spoken");
  const Lines expected = {"/alone -> /ghost on /spoken"};
  EXPECT_EQ(eventually(expected, [] { return missingConnections({"/spoken"}); }), expected);
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
  const Lines expected = {"/babbler -> " + ros::this_node::getName() + " on /spoken"};
  {
    const Registration node("Publisher", "/babbler", "/spoken",
                            "http://localhost:" + std::to_string(server.get_port()) + "/");
    EXPECT_EQ(eventually(expected, [] { return missingConnections({"/spoken"}); }), expected);
  }
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
