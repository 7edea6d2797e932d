// Tests of sim_node with invalid parameters: it reports them and exits with an error.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/node_main.h>
#include <ddm_msgs/testing/run_program.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

namespace ddm {
namespace {

TEST(SimNodeParams, ReportsTheProblemsOfAllBlocksAtOnce) {
  ros::param::set("/bad_node/plnt/length", 1.0);
  ros::param::set("/bad_node/plant/lenght", 1.0);
  ros::param::set("/bad_node/plant/dt", "fast");
  ros::param::set("/bad_node/plant/mass", -1.0);
  ros::param::set("/bad_node/camera/noise_std", -1.0);
  ros::param::set("/bad_node/sim/watchdog", 0.0);
  const testing::Outcome outcome = testing::run(DDM_SIM_NODE " __name:=bad_node 2>&1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(testing::names(outcome.out, {"plnt", "plant/lenght", "plant/dt", "fast", "plant/mass",
                                           "camera/noise_std", "sim/watchdog"}));
}

}  // namespace
}  // namespace ddm
