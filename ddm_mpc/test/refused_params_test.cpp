// Tests of mpc_node and view_node with bad parameters: they say what is wrong and end with an
// error. SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace ddm {
namespace {

/// Runs a program to its end, as the node /bad_node.
std::pair<int, std::string> run(const std::string& program) {
  const std::string command = program + " __name:=bad_node 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  std::array<char, 256> part;
  while (fgets(part.data(), part.size(), pipe) != nullptr) output += part.data();
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

class NodeParams : public ::testing::Test {
 protected:
  void TearDown() override { ros::param::del("/bad_node"); }

  static void expectRefused(const std::string& program, const std::vector<std::string>& words) {
    const auto [exit_code, output] = run(program);
    EXPECT_EQ(exit_code, 1);
    for (const std::string& word : words) {
      EXPECT_NE(output.find(word), std::string::npos) << word << " is not in: " << output;
    }
  }
};

TEST_F(NodeParams, MpcNodeReportsTheProblemsOfAllBlocksAtOnce) {
  ros::param::set("/bad_node/mpc/horizon", 0);
  ros::param::set("/bad_node/controller/timeout", -1.0);
  ros::param::set("/bad_node/image/size", 2);
  expectRefused(DDM_MPC_NODE, {"mpc/horizon", "controller/timeout", "image/size"});
}

TEST_F(NodeParams, MpcNodeRefusesAMisspeltKey) {
  ros::param::set("/bad_node/mpc/horzion", 15);
  expectRefused(DDM_MPC_NODE, {"mpc/horzion", "did you mean horizon?"});
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

int main(int argc, char** argv) {
  ros::init(argc, argv, "refused_params_test");
  ros::NodeHandle nh;  // keeps the node alive for all tests
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
