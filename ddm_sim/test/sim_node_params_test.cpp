// Tests of sim_node with bad parameters: it says what is wrong and ends with an error.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace ddm {
namespace {

/// Runs a second sim_node to its end. Its parameters are those of /bad_sim.
std::pair<int, std::string> runBadSim() {
  const std::string command = std::string(DDM_SIM_NODE) + " __name:=bad_sim 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  std::array<char, 256> part;
  while (fgets(part.data(), part.size(), pipe) != nullptr) output += part.data();
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

class SimNodeParams : public ::testing::Test {
 protected:
  void TearDown() override { ros::param::del("/bad_sim"); }

  /// The node ends with an error that holds each of the words.
  static void expectRefused(const std::vector<std::string>& words) {
    const auto [exit_code, output] = runBadSim();
    EXPECT_EQ(exit_code, 1);
    for (const std::string& word : words) {
      EXPECT_NE(output.find(word), std::string::npos) << word << " is not in: " << output;
    }
  }
};

TEST_F(SimNodeParams, RefusesAMisspeltKey) {
  ros::param::set("/bad_sim/plant/lenght", 1.0);
  expectRefused({"plant/lenght"});
}

TEST_F(SimNodeParams, RefusesAMisspeltBlock) {
  ros::param::set("/bad_sim/plnt/length", 1.0);
  expectRefused({"plnt"});
}

TEST_F(SimNodeParams, ReportsTheProblemsOfAllBlocksAtOnce) {
  ros::param::set("/bad_sim/plant/mass", -1.0);
  ros::param::set("/bad_sim/camera/size", 0);
  ros::param::set("/bad_sim/sim/watchdog", 0.0);
  expectRefused({"plant/mass", "camera/size", "sim/watchdog"});
}

TEST_F(SimNodeParams, RefusesAnUnknownPlantAndListsTheKnownOnes) {
  ros::param::set("/bad_sim/plant/type", "cart");
  expectRefused({"plant/type must be one of: pendulum, moving_tile", "cart"});
}

TEST_F(SimNodeParams, RefusesATileThatFillsThePicture) {
  ros::param::set("/bad_sim/plant/type", "moving_tile");
  ros::param::set("/bad_sim/plant/tile_width", 51.0);
  expectRefused({"plant/tile_width must be smaller than camera/size (51 pixels), got 51"});
}

TEST_F(SimNodeParams, RefusesAValueOfAnotherType) {
  ros::param::set("/bad_sim/plant/dt", "fast");
  expectRefused({"plant/dt", "fast"});
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::init(argc, argv, "sim_node_params_test");
  ros::NodeHandle nh;  // keeps the node alive for all tests
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
