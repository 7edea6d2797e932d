// Tests of the reader of numbers in CSV: accepted texts, and messages for refused texts.
// SPDX-License-Identifier: BSD-3-Clause
#include "number_csv.h"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

using Names = std::vector<std::string>;

std::vector<Eigen::VectorXd> read(const std::string& text, const Names& names = {"torque_nm"}) {
  std::istringstream input(text);
  return readNumbers(input, names, "a torque");
}

const Names kPair = {"dx_px", "dy_px"};

/// The message for a text that must be refused.
std::string refusal(const std::string& text, const Names& names = {"torque_nm"}) {
  try {
    read(text, names);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

TEST(NumberCsv, ReadsOneTorqueALineWithAnyLineEndsAndEmptyLinesAtTheEnd) {
  const auto torques = read("torque_nm\r\n1\r\n -2.5e-1\t\n+.5\n\r\n\n");
  ASSERT_EQ(torques.size(), 3U);
  EXPECT_EQ(Eigen::Vector3d(torques[0][0], torques[1][0], torques[2][0]),
            Eigen::Vector3d(1.0, -0.25, 0.5));
  const auto pairs = read("dx_px,dy_px\n1,-2\n 0.5 ,\t3e-1\r\n\n", kPair);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0], Eigen::Vector2d(1.0, -2.0));
  EXPECT_EQ(pairs[1], Eigen::Vector2d(0.5, 0.3));
}

TEST(NumberCsv, RefusesInputWithoutItsHeader) {
  for (const char* text : {"", "\n", "1\n2\n", "torque\n1\n", "torque_nm,step\n1,2\n"}) {
    EXPECT_TRUE(testing::names(refusal(text), {"line 1: ", " torque_nm"})) << text;
  }
}

TEST(NumberCsv, RefusesARowThatIsNotFiniteNumbersAndNamesLineAndValue) {
  for (const std::string bad : {"nan", "NaN", "inf", "-inf", "1e999", "0x10", "abc", "1,2", "1 2",
                                "1.2.3", "1 # comment", "--1", "e5", "1e"}) {
    EXPECT_TRUE(
        testing::names(refusal("torque_nm\n1\n" + bad + "\n2\n"), {"line 3", "\"" + bad + "\""}));
  }
  for (const std::string bad :
       {"1", "1,", ",1", "1,2,3", "1,2,", "1;2", "1 2", "1,,2", "1,x", "nan,1"}) {
    EXPECT_TRUE(testing::names(refusal("dx_px,dy_px\n1,2\n" + bad + "\n", kPair),
                               {"line 3: ", " 2 ", "dx_px,dy_px", "got \"" + bad + "\""}));
  }
}

TEST(NumberCsv, ShowsNoControlCharactersOfABinaryFile) {
  const std::string message = refusal(std::string("torque_nm\n\x1b[31m") + std::string(500, 'x'));
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_LT(message.size(), 250U);
}

}  // namespace
}  // namespace ddm
