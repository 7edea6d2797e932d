// Tests of the reader of numbers: what it takes, and what it says of the rest.
// SPDX-License-Identifier: BSD-3-Clause
#include "number_csv.h"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

/// Torques of a plant with one motor.
std::vector<double> read(const std::string& text) {
  std::istringstream input(text);
  std::vector<double> values;
  for (const Eigen::VectorXd& torque : readNumbers(input, {"torque_nm"}, "a torque")) {
    EXPECT_EQ(torque.size(), 1);
    values.push_back(torque[0]);
  }
  return values;
}

std::vector<Eigen::VectorXd> readPairs(const std::string& text) {
  std::istringstream input(text);
  return readNumbers(input, {"dx_px", "dy_px"}, "a torque");
}

template <class Reader>
std::string refusal(const std::string& text, const Reader& reader) {
  try {
    reader(text);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

std::string refusal(const std::string& text) { return refusal(text, read); }

TEST(NumberCsv, ReadsOneValueALine) {
  EXPECT_EQ(read("torque_nm\n1\n-2.5e-1\n+.5\n"), (std::vector<double>{1.0, -0.25, 0.5}));
}

TEST(NumberCsv, ReadsWindowsLineEndsAndEmptyLinesAtTheEnd) {
  EXPECT_EQ(read("torque_nm\r\n1\r\n 2\t\r\n\r\n\n"), (std::vector<double>{1.0, 2.0}));
}

TEST(NumberCsv, RefusesInputWithoutItsHeader) {
  for (const char* text : {"", "\n", "1\n2\n", "torque\n1\n", "torque_nm,step\n1,2\n"}) {
    EXPECT_TRUE(testing::names(refusal(text), {"line 1: ", " torque_nm"})) << text;
  }
}

TEST(NumberCsv, RefusesWhatIsNoFiniteNumberAndNamesTheLineAndTheValue) {
  for (const char* bad : {"nan", "NaN", "inf", "-inf", "1e999", "0x10", "abc", "1,2", "1 2",
                          "1.2.3", "1 # comment", "--1", "e5", "1e"}) {
    const std::string message = refusal("torque_nm\n1\n" + std::string(bad) + "\n2\n");
    EXPECT_NE(message.find("line 3"), std::string::npos) << bad << ": " << message;
    EXPECT_NE(message.find("\"" + std::string(bad) + "\""), std::string::npos) << message;
  }
}

TEST(NumberCsv, ReadsARowOfNumbersForAPlantWithSeveralMotors) {
  const auto torques = readPairs("dx_px,dy_px\n1,-2\n 0.5 ,\t3e-1\r\n\n");
  ASSERT_EQ(torques.size(), 2U);
  EXPECT_EQ(torques[0], Eigen::Vector2d(1.0, -2.0));
  EXPECT_EQ(torques[1], Eigen::Vector2d(0.5, 0.3));
}

TEST(NumberCsv, RefusesARowWithMoreOrFewerNumbersAndSaysHowMany) {
  for (const char* bad : {"1", "1,", ",1", "1,2,3", "1,2,", "1;2", "1 2", "1,,2", "1,x", "nan,1"}) {
    const std::string message = refusal("dx_px,dy_px\n1,2\n" + std::string(bad) + "\n", readPairs);
    EXPECT_TRUE(testing::names(
        message, {"line 3: ", " 2 ", "dx_px,dy_px", "got \"" + std::string(bad) + "\""}));
  }
}

TEST(NumberCsv, ShowsNoControlCharactersOfABinaryFile) {
  const std::string message = refusal(std::string("torque_nm\n\x1b[31m") + std::string(500, 'x'));
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_LT(message.size(), 250U);
}

}  // namespace
}  // namespace ddm
