// Tests of single configuration values: accepted texts, refused texts, exact printing.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/param_value.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace ddm {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Whether the YAML text has the type of `value`, which then receives the value.
template <class Value>
bool parses(const std::string& text, Value* value) {
  return parseValue(YAML::Load(text), value);
}

/// Expects that each text of `right` gives its value and is printed as the same value, and that the
/// texts of `wrong` change nothing.
template <class Value>
void expectType(const std::vector<std::pair<std::string, Value>>& right,
                const std::vector<std::string>& wrong, const Value& before) {
  for (const auto& [text, expected] : right) {
    Value value = before, again = before;
    EXPECT_TRUE(parses(text, &value)) << text;
    EXPECT_EQ(value, expected) << text;
    EXPECT_TRUE(parses(YAML::Dump(valueToYaml(value)), &again)) << text;
    EXPECT_EQ(again, expected) << text;
  }
  for (const std::string& text : wrong) {
    Value value = before;
    EXPECT_FALSE(parses(text, &value)) << text;
    EXPECT_EQ(value, before) << text;
  }
}

TEST(ParamValue, HasTheStrictTextsOfEachType) {
  expectType<int>({{"0", 0},
                   {"-15", -15},
                   {"+7", 7},
                   {"2147483647", 2147483647},
                   {"-2147483648", std::numeric_limits<int>::min()}},
                  {"15.5", "15.0", "abc", "2147483648", "-2147483649", "1e3", "0x10", "010", "1 2",
                   "-", "+-1", "''", "~", "[1]", "{a: 1}", "true"},
                  42);
  expectType<double>({{"0.2", 0.2},
                      {"15", 15.0},
                      {"-3", -3.0},
                      {"1e-4", 1e-4},
                      {"1.5E+3", 1500.0},
                      {".5", 0.5},
                      {"2.", 2.0},
                      {"'1e-4'", 1e-4},
                      {"+0.5", 0.5},
                      {".inf", kInf},
                      {"+.inf", kInf},
                      {"-Infinity", -kInf},  // of JSON
                      {"-.inf", -kInf}},
                     {"high", "1e", "0x10", "1,5", "1 2", "1e999", "--1", "''", "~", "[1]", "true"},
                     42.0);
  expectType<bool>({{"true", true}, {"false", false}},
                   {"yes", "no", "on", "True", "1", "0", "~", "[true]"}, true);
  expectType<std::string>({{"goal.png", "goal.png"}, {"''", ""}, {"7", "7"}},
                          {"~", "[a]", "{a: b}"}, "before");
  expectType<std::vector<int>>({{"[50, 25, 12]", {50, 25, 12}}, {"[]", {}}},
                               {"[50, 2.5]", "50", "[[50]]"}, {1});
  expectType<std::vector<double>>({{"[1, 1e-4]", {1.0, 1e-4}}, {"2.5", {2.5}}}, {"[1, x]", "x"},
                                  {1.0});
  expectType<std::vector<std::string>>(
      {{"[a.bag, 'b, c.bag', 7]", {"a.bag", "b, c.bag", "7"}}, {"[]", {}}},
      {"a.bag", "[a.bag, [b.bag]]"}, {"before"});
  expectType<std::vector<std::vector<double>>>(
      {{"[[-2, 2.5], []]", {{-2.0, 2.5}, {}}}, {"[[1, 2], 3]", {{1.0, 2.0}, {3.0}}}},
      {"1.0", "[[x]]", "[[[1.0]]]", "{a: [1.0]}"}, {{1.0}});
}

TEST(ParamValue, ReadsNaNSoThatTheOptionsCanRefuseIt) {
  for (const char* text : {".nan", ".NaN", "nan", "NaN"}) {
    double value = 0.0;
    EXPECT_TRUE(parses(text, &value)) << text;
    EXPECT_TRUE(std::isnan(value)) << text;
  }
}

TEST(ParamValue, PrintsDoublesShortWithAPointAndListsInFlowStyle) {
  const std::vector<std::pair<double, std::string>> forms = {
      {0.2, "0.2"},      {6.0, "6.0"},         {-0.0, "-0.0"},
      {1e-5, "1.0e-05"}, {2.5e-10, "2.5e-10"}, {0.1 + 0.2, "0.30000000000000004"},
      {kInf, ".inf"},    {-kInf, "-.inf"},     {std::nan(""), ".nan"}};
  for (const auto& [value, text] : forms) EXPECT_EQ(formatDouble(value), text);
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<int>{50, 25})), "[50, 25]");
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<double>{6.0})), "6.0");
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<std::vector<double>>{{6.0}})), "[6.0]");
}

TEST(ParamValue, PrintsEveryFiniteDoubleSoThatItReadsBackExactly) {
  std::mt19937_64 engine(1);
  std::vector<double> values = {std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::min(), 1.0 / 3.0, 123456789.0};
  while (values.size() < 2000) {
    const std::uint64_t bits = engine();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof(value));
    if (std::isnormal(value)) values.push_back(value);
  }
  for (const double value : values) {
    double read_back = 0.0;
    EXPECT_TRUE(parses(formatDouble(value), &read_back)) << formatDouble(value);
    EXPECT_EQ(read_back, value) << formatDouble(value);
  }
}

TEST(ParamValue, ANumberOfACommandLineIsFiniteAndMayHaveBlanksAroundIt) {
  double value = 0.0;
  EXPECT_TRUE(parseNumber(" -2.5e-1\t", &value));
  EXPECT_EQ(value, -0.25);
  for (const char* text : {"", "nan", ".nan", "inf", ".inf", "0x10", "1e999", "1 N", "1 2"}) {
    EXPECT_FALSE(parseNumber(text, &value)) << text;
    EXPECT_EQ(value, -0.25) << text;
  }
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(ParamValue, IsTheSameUnderALocaleWithADecimalComma) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  double value = 0.0, number = 0.0;
  const bool parsed = parses("1.5", &value) && parseNumber("1.5", &number);
  const std::string text = formatDouble(1.5);
  std::locale::global(before);
  EXPECT_TRUE(parsed);
  EXPECT_EQ(value, 1.5);
  EXPECT_EQ(number, 1.5);
  EXPECT_EQ(text, "1.5");
}

}  // namespace
}  // namespace ddm
