// Test fixture: a node with invalid parameters reports them and exits with an error.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

#include <string>
#include <vector>

#include "ddm_msgs/testing/run_program.h"

namespace ddm {
namespace testing {

/// Fixture for tests that set parameters of /bad_node.
class RefusedParams : public ::testing::Test {
 protected:
  void TearDown() override { ros::param::del("/bad_node"); }

  /// Runs a program as /bad_node and expects exit code 1 and output that contains each of the
  /// words.
  static void expectRefused(const std::string& program, const std::vector<std::string>& words) {
    const Outcome outcome = run(program + " __name:=bad_node 2>&1");
    EXPECT_EQ(outcome.exit_code, 1);
    for (const std::string& word : words) {
      EXPECT_TRUE(contains(outcome.out, word)) << word << " is not in: " << outcome.out;
    }
  }
};

}  // namespace testing
}  // namespace ddm
