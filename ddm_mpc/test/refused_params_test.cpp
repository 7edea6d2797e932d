// Tests of mpc_node and view_node with bad parameters: they end and say what is wrong.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <ddm_msgs/testing/refused_params.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

namespace ddm {
namespace {

using NodeParams = testing::RefusedParams;

TEST_F(NodeParams, MpcNodeReportsTheProblemsOfAllBlocksAtOnce) {
  ros::param::set("/bad_node/mpc/horizon", 0);
  ros::param::set("/bad_node/controller/timeout", -1.0);
  ros::param::set("/bad_node/image/size", 2);
  expectRefused(DDM_MPC_NODE, {"mpc/horizon", "controller/timeout", "image/size"});
}

TEST_F(NodeParams, MpcNodeRefusesAMisspeltKey) {
  ros::param::set("/bad_node/mpc/horzion", 15);
  expectRefused(DDM_MPC_NODE, {"mpc/horzion", "horizon?"});
}

TEST_F(NodeParams, MpcNodeRefusesAMisspeltBlock) {
  ros::param::set("/bad_node/mcp/horizon", 15);
  expectRefused(DDM_MPC_NODE, {"mcp"});
}

TEST_F(NodeParams, ViewNodeRefusesAnImageSizeOutOfRange) {
  ros::param::set("/bad_node/image/size", 0);
  expectRefused(DDM_VIEW_NODE, {"image/size", "got 0"});
}

TEST_F(NodeParams, ViewNodeRefusesAMisspeltKey) {
  ros::param::set("/bad_node/image/sise", 51);
  expectRefused(DDM_VIEW_NODE, {"image/sise"});
}

}  // namespace
}  // namespace ddm
