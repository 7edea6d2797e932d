// Tests of values from the command line and of paths in a home folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/config_blocks.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "ddm_common/plain_file.h"
#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

YAML::Node blocksWith(const std::string& text) {
  YAML::Node blocks = YAML::Load("mpc: {horizon: 15}");
  setValue(text, &blocks);
  return blocks;
}

TEST(SetValue, SetsTextsNumbersAndLists) {
  EXPECT_EQ(blocksWith("mpc/horizon=20")["mpc"]["horizon"].as<int>(), 20);
  EXPECT_EQ(blocksWith("a/b= x: #1 = {y}")["a"]["b"].Scalar(), " x: #1 = {y}");
  const YAML::Node motors = blocksWith("plant/motors=[shoulder, 'my elbow']")["plant"]["motors"];
  ASSERT_TRUE(motors.IsSequence());
  EXPECT_EQ(motors[1].Scalar(), "my elbow");
}

TEST(SetValue, AnEmptyValueCountsAsNotGiven) {
  EXPECT_EQ(blocksWith("mpc/horizon=")["mpc"]["horizon"].as<int>(), 15);
}

TEST(SetValue, ATextOfAnotherFormIsRefused) {
  for (const std::string text :
       {"horizon=20", "mpc/horizon", "mpc=a/b", "/horizon=2", "mpc/=2", "mpc/a=[1, {]"}) {
    EXPECT_TRUE(
        testing::throwsNaming<std::invalid_argument>([&] { blocksWith(text); }, {"--set", text}));
  }
}

TEST(ExpandHome, ReplacesATildeAtTheStartOfAPathOnly) {
  const char* const home = std::getenv("HOME");
  const std::string before = home == nullptr ? "" : home;
  ::setenv("HOME", "/home/me", /*overwrite=*/1);
  EXPECT_EQ(expandHome("~/x y"), "/home/me/x y");
  EXPECT_EQ(expandHome("~"), "/home/me");
  EXPECT_EQ(expandHome("--out=~/x"), "--out=/home/me/x");
  for (const std::string text : {"", "x", "./~/x", "a~", "~root/x", "--out", "--out=a~/x", "-~"}) {
    EXPECT_EQ(expandHome(text), text);
  }
  ::setenv("HOME", before.c_str(), /*overwrite=*/1);
}

}  // namespace
}  // namespace ddm
