// A node with bad parameters says what is wrong and ends with an error.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace ddm {
namespace testing {

/// For tests that set parameters of /bad_node.
class RefusedParams : public ::testing::Test {
 protected:
  void TearDown() override { ros::param::del("/bad_node"); }

  /// Runs a program as /bad_node to its end, which must be an error with each of the words.
  static void expectRefused(const std::string& program, const std::vector<std::string>& words) {
    const auto [exit_code, output] = run(program + " __name:=bad_node 2>&1");
    EXPECT_EQ(exit_code, 1);
    for (const std::string& word : words) {
      EXPECT_NE(output.find(word), std::string::npos) << word << " is not in: " << output;
    }
  }

 private:
  static std::pair<int, std::string> run(const std::string& command) {
    FILE* pipe = popen(command.c_str(), "r");
    std::string output;
    std::array<char, 256> part;
    while (fgets(part.data(), part.size(), pipe) != nullptr) output += part.data();
    const int status = pclose(pipe);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
  }
};

}  // namespace testing
}  // namespace ddm
