// Tests of how mpc_node stops two motors, and that it does so while a plan is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <std_msgs/Float64MultiArray.h>

#include <string>
#include <vector>

#include "trial_client.h"

namespace ddm {
namespace {

const std::vector<double> kZeros = {0.0, 0.0};

/// The launch file starts a node for two motors with a timeout of 2 s, where a plan takes minutes.
class TwoMotors : public MpcNodeTest {
 protected:
  using MpcNodeTest::MpcNodeTest;

  void SetUp() override {
    MpcNodeTest::SetUp();
    ASSERT_TRUE(waitUntil([this] { return effort_.connected(); }));
  }

  /// Each torque went to the motors, and zeros went after the last one.
  void expectEffortsOfTorquesAndThenZeros() {
    ASSERT_TRUE(waitUntil([this] { return effort_.messages.size() > torque_.messages.size(); }));
    for (std::size_t step = 0; step < torque_.messages.size(); ++step) {
      EXPECT_EQ(effort_.messages[step].data, torque_.messages[step].torque);
      EXPECT_NE(effort_.messages[step].data, kZeros);
    }
    EXPECT_EQ(effort_.messages.back().data, kZeros);
  }

  Listener<std_msgs::Float64MultiArray> effort_{client_.nh, topics::kGroupEffortCommand};
};

TEST_F(TwoMotors, GetZeroAtTheEndOfATrial) {
  begin(trialGoal(3, 1.0));
  show(3);
  expectEnd(State::SUCCEEDED);
  expectEffortsOfTorquesAndThenZeros();
  EXPECT_EQ(effort_.messages.size(), 4U);
}

TEST_F(TwoMotors, GetZeroWhenATrialIsCancelled) {
  begin(trialGoal(10, 1.0));
  show(2);
  action_.cancelGoal();
  expectEnd(State::PREEMPTED);
  expectEffortsOfTorquesAndThenZeros();
}

TEST_F(TwoMotors, GetZeroWhenATrialTimesOut) {
  begin(trialGoal(10, 1.0));
  show(2);
  expectEnd(State::ABORTED, {"no image after step 2"});
  expectEffortsOfTorquesAndThenZeros();
}

TEST_F(TwoMotors, GetZeroWhenAnImageIsRefused) {
  begin(trialGoal(10, 1.0));
  show(2);
  client_.publishImage(kSize + 1, 1);
  expectEnd(State::ABORTED, {"image refused"});
  ASSERT_TRUE(waitUntil([this] { return effort_.messages.size() == 4; }));
  EXPECT_EQ(effort_.messages[2].data, kZeros);
  EXPECT_EQ(effort_.messages[3].data, kZeros);
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::init(argc, argv, "mpc_node_stop_test");
  ros::NodeHandle nh;  // keeps the node alive for all tests
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
