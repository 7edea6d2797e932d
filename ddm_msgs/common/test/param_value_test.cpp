// Tests of single configuration values: what is accepted, what is refused, exact printing.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/param_value.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ddm_common/parse_number.h"

namespace ddm {
namespace {

/// True if the YAML text has the type; `value` then holds it.
template <class Value>
bool parses(const std::string& text, Value* value) {
  return parseValue(YAML::Load(text), value);
}

TEST(ParamValue, ReadsIntegersOfThirtyTwoBits) {
  int value = 0;
  for (const int expected : {0, 15, -15, 2147483647, std::numeric_limits<int>::min()}) {
    EXPECT_TRUE(parses(std::to_string(expected), &value)) << expected;
    EXPECT_EQ(value, expected);
  }
  EXPECT_TRUE(parses("+7", &value));
  EXPECT_EQ(value, 7);
}

TEST(ParamValue, RefusesWhatIsNoIntegerAndLeavesTheValueAlone) {
  for (const char* text : {"15.5", "15.0", "abc", "2147483648", "-2147483649", "1e3", "0x10", "010",
                           "1 2", "-", "+-1", "''", "~", "[1]", "{a: 1}", "true"}) {
    int value = 42;
    EXPECT_FALSE(parses(text, &value)) << text;
    EXPECT_EQ(value, 42) << text;
  }
}

TEST(ParamValue, ReadsNumbersInEveryUsualForm) {
  const std::vector<std::pair<std::string, double>> forms = {
      {"0.2", 0.2}, {"15", 15.0}, {"-3", -3.0},     {"1e-4", 1e-4}, {"1.5E+3", 1500.0},
      {".5", 0.5},  {"2.", 2.0},  {"'1e-4'", 1e-4}, {"+0.5", 0.5}};
  for (const auto& form : forms) {
    double value = 42.0;
    EXPECT_TRUE(parses(form.first, &value)) << form.first;
    EXPECT_EQ(value, form.second) << form.first;
  }
}

TEST(ParamValue, ReadsInfinityAndNaNSoThatTheOptionsCanRefuseThem) {
  double value = 0.0;
  for (const char* text : {".nan", ".NaN", "nan"}) {
    value = 0.0;
    EXPECT_TRUE(parses(text, &value)) << text;
    EXPECT_TRUE(std::isnan(value)) << text;
  }
  for (const char* text : {".inf", "+.inf", "inf"}) {
    value = 0.0;
    EXPECT_TRUE(parses(text, &value)) << text;
    EXPECT_EQ(value, std::numeric_limits<double>::infinity()) << text;
  }
  EXPECT_TRUE(parses("-.inf", &value));
  EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
}

TEST(ParamValue, RefusesWhatIsNoNumber) {
  for (const char* text : {"abc", "0x10", "1e", "1,5", "1.5 N", "1e999", "''", "~", "[1.0]", "true",
                           "--1", "+-.inf"}) {
    double value = 42.0;
    EXPECT_FALSE(parses(text, &value)) << text;
    EXPECT_EQ(value, 42.0) << text;
  }
}

TEST(ParamValue, TakesOnlyTrueAndFalseForBool) {
  bool value = false;
  EXPECT_TRUE(parses("true", &value));
  EXPECT_TRUE(value);
  EXPECT_TRUE(parses("false", &value));
  EXPECT_FALSE(value);
  for (const char* text : {"yes", "no", "on", "True", "1", "0", "~", "[true]"}) {
    EXPECT_FALSE(parses(text, &value)) << text;
  }
}

TEST(ParamValue, ReadsTextsButNeitherListsNorNothing) {
  std::string value = "before";
  EXPECT_TRUE(parses("goal.png", &value));
  EXPECT_EQ(value, "goal.png");
  EXPECT_TRUE(parses("''", &value));
  EXPECT_EQ(value, "");
  for (const char* text : {"~", "[a]", "{a: b}"}) EXPECT_FALSE(parses(text, &value)) << text;
}

TEST(ParamValue, ReadsListsAndRefusesAListWithOneWrongElement) {
  std::vector<int> widths = {1};
  EXPECT_TRUE(parses("[50, 25, 12]", &widths));
  EXPECT_EQ(widths, std::vector<int>({50, 25, 12}));
  EXPECT_FALSE(parses("[50, 2.5]", &widths));
  EXPECT_FALSE(parses("50", &widths));
  EXPECT_FALSE(parses("[[50]]", &widths));
  EXPECT_EQ(widths, std::vector<int>({50, 25, 12}));
  EXPECT_TRUE(parses("[]", &widths));
  EXPECT_TRUE(widths.empty());

  std::vector<double> start;
  EXPECT_TRUE(parses("[1, 1e-4]", &start));
  EXPECT_EQ(start, std::vector<double>({1.0, 1e-4}));
  EXPECT_FALSE(parses("[1, x]", &start));
  EXPECT_FALSE(parses("x", &start));
  EXPECT_TRUE(parses("2.5", &start));
  EXPECT_EQ(start, std::vector<double>({2.5}));
}

TEST(ParamValue, PrintsDoublesShortAndAlwaysWithAPoint) {
  EXPECT_EQ(formatDouble(0.2), "0.2");
  EXPECT_EQ(formatDouble(6.0), "6.0");
  EXPECT_EQ(formatDouble(-0.0), "-0.0");
  EXPECT_EQ(formatDouble(1e-5), "1.0e-05");
  EXPECT_EQ(formatDouble(2.5e-10), "2.5e-10");
  EXPECT_EQ(formatDouble(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(formatDouble(std::numeric_limits<double>::infinity()), ".inf");
  EXPECT_EQ(formatDouble(-std::numeric_limits<double>::infinity()), "-.inf");
  EXPECT_EQ(formatDouble(std::numeric_limits<double>::quiet_NaN()), ".nan");
}

TEST(ParamValue, PrintsEveryFiniteDoubleSoThatItReadsBackExactly) {
  std::mt19937_64 engine(1);
  std::vector<double> values = {std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::lowest(),
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

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(ParamValue, TextIsANumberUnderALocaleOfCWithADecimalCommaToo) {
  bool found = false;
  for (const char* name :
       {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "nl_NL.UTF-8"}) {
    found = found || std::setlocale(LC_NUMERIC, name) != nullptr;
  }
  if (!found) GTEST_SKIP() << "no such locale is installed";
  double value = 0.0;
  const bool parsed = parseNumber("1.5", &value);
  std::setlocale(LC_NUMERIC, "C");
  EXPECT_TRUE(parsed);
  EXPECT_EQ(value, 1.5);
}

TEST(ParamValue, IsTheSameUnderALocaleWithADecimalComma) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  double value = 0.0;
  const bool parsed = parses("1.5", &value);
  const std::string text = formatDouble(1.5);
  std::locale::global(before);
  EXPECT_TRUE(parsed);
  EXPECT_EQ(value, 1.5);
  EXPECT_EQ(text, "1.5");
}

TEST(ParamValue, WritesListsInFlowStyle) {
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<int>{50, 25})), "[50, 25]");
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<double>{0.2, 1.0})), "[0.2, 1.0]");
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<double>{6.0})), "6.0");
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<std::vector<double>>{{6.0}})), "[6.0]");
  EXPECT_EQ(YAML::Dump(valueToYaml(std::vector<int>{})), "[]");
}

TEST(ParamValue, ReadsAndPrintsListsOfTexts) {
  std::vector<std::string> value = {"before"};
  EXPECT_FALSE(parses("a.bag", &value));
  EXPECT_FALSE(parses("[a.bag, [b.bag]]", &value));
  EXPECT_EQ(value, (std::vector<std::string>{"before"}));
  EXPECT_TRUE(parses("[a.bag, 'b, c.bag', 7]", &value));
  EXPECT_EQ(value, (std::vector<std::string>{"a.bag", "b, c.bag", "7"}));
  std::vector<std::string> again;
  EXPECT_TRUE(parses(YAML::Dump(valueToYaml(value)), &again));
  EXPECT_EQ(again, value);
  EXPECT_TRUE(parses("[]", &again));
  EXPECT_TRUE(again.empty());
}

TEST(ParamValue, ReadsAndPrintsListsOfLists) {
  std::vector<std::vector<double>> value = {{1.0}};
  for (const char* wrong : {"1.0", "[[x]]", "[[[1.0]]]", "{a: [1.0]}"}) {
    EXPECT_FALSE(parses(wrong, &value)) << wrong;
  }
  EXPECT_EQ(value, (std::vector<std::vector<double>>{{1.0}}));
  EXPECT_TRUE(parses("[[-2, 2.5], []]", &value));
  EXPECT_EQ(value, (std::vector<std::vector<double>>{{-2.0, 2.5}, {}}));
  EXPECT_EQ(YAML::Dump(valueToYaml(value)), "[[-2.0, 2.5], []]");
  EXPECT_TRUE(parses("[[1, 2], 3]", &value));
  EXPECT_EQ(value, (std::vector<std::vector<double>>{{1.0, 2.0}, {3.0}}));
  EXPECT_EQ(YAML::Dump(valueToYaml(value)), "[[1.0, 2.0], 3.0]");
}

}  // namespace
}  // namespace ddm
