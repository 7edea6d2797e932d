// Fixture with the run folder of a small experiment, for the tests of run folders.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "run_folder.h"
#include "toy_run.h"

namespace ddm {
namespace testing {

class RunFolderCase : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return scratch_.file("run/" + name); }

  /// Makes the folder and finishes `num_trials` trials.
  void finish(int num_trials) {
    RunFolder folder(configuration_);
    for (int trial = 0; trial < num_trials; ++trial) {
      writeText(folder.beginRun({trial}), "a bag");
      folder.finishTrial(toyRow(trial));
    }
  }

  void expectRefused(const std::vector<std::string>& words) {
    EXPECT_TRUE(
        throwsNaming<std::runtime_error>([this] { RunFolder folder(configuration_); }, words));
  }

  TempFolder scratch_;
  Configuration configuration_ = toyConfiguration(scratch_.file("run"));
};

}  // namespace testing
}  // namespace ddm
