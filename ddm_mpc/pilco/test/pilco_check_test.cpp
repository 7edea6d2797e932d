// Tests of pilco_check: what it accepts, what it finds, what it says.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/run_program.h"
#include "ddm_msgs/testing/temp_folder.h"

namespace ddm {
namespace pilco {
namespace {

std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

/// One step without gravity, where the pendulum is linear.
std::string simulateCase(const std::string& id, double falsified_by = 0.0) {
  const double rate = 0.7, angle = -0.4, torque = 3.0, decay = std::exp(-0.6);
  const double next_rate = decay * rate + (1.0 - decay) * torque;
  const double next_angle = angle + (rate - torque) * (1.0 - decay) / 3.0 + 0.2 * torque;
  return R"({"id": ")" + id +
         R"(", "scenario": "f9707a9", "dt": 0.2, "x0": [0.7, -0.4], "u": 3, )" + R"("x1": [)" +
         digits(next_rate) + ", " + digits(next_angle + falsified_by) + "]}";
}

/// A cost of one dimension, in closed form.
std::string lossCase() {
  const double w = 2.0, s = 0.3, d = 0.8;  // mean minus target
  const double p = w / (1.0 + s * w);
  const double reward = std::exp(-0.5 * d * d * p) / std::sqrt(1.0 + s * w);
  const double squared = std::exp(-d * d * w / (1.0 + 2.0 * s * w)) / std::sqrt(1.0 + 2.0 * s * w);
  return R"({"id": "loss1", "D": 1, "z": [0.2], "W": [[2]], "m": [1], "s": [[0.3]], "L": )" +
         digits(1.0 - reward) + R"(, "dLdm": [)" + digits(reward * d * p) + R"(], "dLds": [[)" +
         digits(reward * 0.5 * (p - d * d * p * p)) + R"(]], "var": )" +
         digits(squared - reward * reward) + "}";
}

/// The sine of one angle, in closed form.
std::string sineCase() {
  const double m = 0.5, v = 0.4, e = 1.5, q = std::exp(-v);
  const double variance = 0.5 * e * e * ((1.0 - q) - (q * q - q) * std::cos(2.0 * m));
  return R"({"id": "sine1", "m": [0.5], "v": [[0.4]], "index1": [1], "e": [1.5], "M": [)" +
         digits(e * std::sqrt(q) * std::sin(m)) + R"(], "V": [[)" + digits(variance) +
         R"(]], "C": [[)" + digits(e * std::sqrt(q) * std::cos(m)) + "]]}";
}

std::string goodFile() {
  return R"({"meta": {"source": "closed forms"}, "gsin": [)" + sineCase() + R"(], "loss_sat": [)" +
         lossCase() + R"(], "simulate": [)" + simulateCase("sim1") + ", " + simulateCase("sim2") +
         "]}";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) ADD_FAILURE() << "there is no " << what << " in " << text;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

using ddm::testing::Outcome;

Outcome run(const std::string& arguments) {
  return ddm::testing::run(std::string(DDM_PILCO_CHECK) + " " + arguments + " 2>&1");
}

Outcome check(const std::string& content) {
  const ::ddm::testing::TempFolder folder;
  std::ofstream(folder.file("values.json")) << content;
  return run(folder.file("values.json"));
}

::testing::AssertionResult fails(const std::string& content,
                                 const std::vector<std::string>& parts) {
  const Outcome outcome = check(content);
  if (outcome.exit_code == 1) return ::ddm::testing::names(outcome.out, parts);
  return ::testing::AssertionFailure() << "exit code " << outcome.exit_code << ": " << outcome.out;
}

TEST(PilcoCheck, AcceptsWhatClosedFormsSayAndTellsWhichKindsHaveNoCases) {
  const Outcome outcome = check(goodFile());
  EXPECT_EQ(0, outcome.exit_code) << outcome.out;
  EXPECT_NE(std::string::npos, outcome.out.find("simulate             2")) << outcome.out;
  EXPECT_NE(std::string::npos, outcome.out.find("gp_predict: no cases"));
  EXPECT_EQ(std::string::npos, outcome.out.find("gsin: no cases"));
  EXPECT_NE(std::string::npos, outcome.out.find("tolerances"));
}

TEST(PilcoCheck, AcceptsIndentedFiles) {
  EXPECT_EQ(0, check(replaced(goodFile(), "\"gsin\"", "\r\n\t\"gsin\"")).exit_code);
}

TEST(PilcoCheck, FindsASingleFalsifiedNumber) {
  const std::string file = replaced(goodFile(), simulateCase("sim2"), simulateCase("sim2", 3e-9));
  EXPECT_TRUE(fails(file, {"simulate: case sim2, field x1, entry (2, 1): "}));
  EXPECT_TRUE(fails(file, {"failed: simulate\n"}));
  EXPECT_EQ(
      0, check(replaced(goodFile(), simulateCase("sim2"), simulateCase("sim2", 3e-10))).exit_code)
      << "this is within the tolerance";
}

TEST(PilcoCheck, FindsAFalsifiedInputAndConstant) {
  EXPECT_TRUE(fails(replaced(goodFile(), "\"u\": 3,", "\"u\": 3.001,"), {"failed: simulate"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"dt\": 0.2", "\"dt\": 0.25"), {"case sim1, field dt"}));
  EXPECT_TRUE(
      fails(replaced(goodFile(), "\"z\": [0.2]", "\"z\": [0.20001]"), {"failed: loss_sat"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "[1.5]", "[-1.5]"), {"failed: gsin"}));
}

TEST(PilcoCheck, NamesKindCaseAndFieldOfWhatIsNoFiniteNumber) {
  for (const char* bad : {"NaN", "Infinity", "\"3\"", "null", "1e999"}) {
    EXPECT_TRUE(fails(replaced(goodFile(), "\"u\": 3,", std::string("\"u\": ") + bad + ","),
                      {"simulate: case sim1, field u: "}))
        << bad;
  }
  EXPECT_TRUE(fails(replaced(goodFile(), "\"x0\": [0.7, -0.4]", "\"x0\": [0.7, NaN]"),
                    {"simulate: case sim1, field x0: ", "got NaN"}));
}

TEST(PilcoCheck, NamesMissingUnknownRepeatedAndMisshapenFields) {
  EXPECT_TRUE(
      fails(replaced(goodFile(), "\"u\": 3, ", ""), {"simulate: case sim1, field u: ", "missing"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"u\": 3", "\"u\": 3, \"v\": 1"),
                    {"simulate: case sim1, field v: ", "unknown"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"u\": 3", "\"u\": 3, \"u\": 3"),
                    {"simulate: case sim1, field u: ", "twice"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "[0.7, -0.4]", "[0.7, -0.4, 1]"),
                    {"simulate: case sim1, field x0: ", "2 x 1", "got 3 x 1"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"W\": [[2]]", "\"W\": [[2, 1]]"),
                    {"loss_sat: case loss1, field W: ", "1 x 1", "got 1 x 2"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "[0.7, -0.4]", "[[0.7], [-0.4, 1]]"),
                    {"simulate: case sim1, field x0: ", "rows"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"D\": 1", "\"D\": 2"),
                    {"loss_sat: case loss1, field D: ", " 1, ", "got 2"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"f9707a9\"", "\"f9707a8\""),
                    {"simulate: case sim1, field scenario: "}));
  EXPECT_TRUE(fails(replaced(goodFile(), "sim2", "sim1"), {"case sim1, field id: ", "twice"}));
}

TEST(PilcoCheck, FindsAComputedNumberThatIsNotFiniteBesideOnesThatAreRight) {
  // A negative variance, which overflows, in the first entry; the last is right.
  const std::string right = digits(0.5 * (1.0 - std::exp(-0.4)) * (1.0 + std::exp(-0.4)));
  const std::string file =
      R"({"gsin": [{"id": "a", "m": [0, 0], "v": [[-1e6, 0], [0, 0.4]], "index1": [1, 2], )"
      R"("e": [1, 1], "M": [0, 0], "V": [[0, 0], [0, )" +
      right + R"(]], "C": [[0, 0], [0, )" + digits(std::exp(-0.2)) + "]]}]}";
  EXPECT_TRUE(fails(file, {"gsin: case a, field V, entry (1, 1): ", "has 0, "}));
  EXPECT_EQ(std::string::npos, check(file).out.find("entry (2, 2)"));
}

TEST(PilcoCheck, ComparesTheOtherCasesOfAKindWithAnUnreadableOne) {
  const std::string file = replaced(
      replaced(goodFile(), simulateCase("sim2"), simulateCase("sim2", 1e-3)), "\"u\": 3, ", "");
  EXPECT_TRUE(fails(file, {"case sim1, field u: ", "missing"}));
  EXPECT_TRUE(fails(file, {"case sim2, field x1, entry"}));
}

TEST(PilcoCheck, FailsWithUnknownKindsAndWithoutAnyCase) {
  EXPECT_TRUE(fails(replaced(goodFile(), "\"gsin\"", "\"gsine\""), {"gsine: ", "unknown"}));
  EXPECT_TRUE(fails(replaced(goodFile(), "\"gsin\"", "\"gsine\""), {"failed: gsine"}));
  EXPECT_TRUE(fails(R"({"gsin": 1})", {"gsin: ", "list"}));
  const Outcome none = check(R"({"meta": {"source": "none"}})");
  EXPECT_EQ(1, none.exit_code);
  EXPECT_EQ(std::string::npos, none.out.find("failed")) << none.out;
}

TEST(PilcoCheck, NamesAKindWhoseListIsEmpty) {
  const std::string file = replaced(goodFile(), "\"gsin\"", "\"gp_predict\": [], \"gsin\"");
  EXPECT_TRUE(fails(file, {"gp_predict: ", "list"}));
  EXPECT_TRUE(fails(file, {"failed: gp_predict\n"}));
}

TEST(PilcoCheck, NamesAFileThatIsDamaged) {
  const std::string file = goodFile();
  EXPECT_TRUE(fails(file.substr(0, file.size() / 2), {"values.json:1: "}));
  EXPECT_TRUE(fails("", {"values.json: ", "object"}));
  EXPECT_TRUE(fails("[1, 2]", {"values.json: ", "object"}));
}

TEST(PilcoCheck, AcceptsTheReferenceValuesOfTheEnvironment) {
  const char* const file = std::getenv("DDM_PILCO_VECTORS");
  if (file == nullptr || *file == '\0') {
    GTEST_SKIP() << "DDM_PILCO_VECTORS names no file: nothing was compared";
  }
  const Outcome outcome = run("'" + std::string(file) + "'");
  EXPECT_EQ(0, outcome.exit_code) << outcome.out;
  EXPECT_NE(std::string::npos, outcome.out.find("tolerances")) << outcome.out;
}

TEST(PilcoCheck, ExplainsItsUse) {
  for (const char* arguments : {"", "one two", "--nonsense"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(2, outcome.exit_code) << arguments;
  }
  const Outcome help = run("--help");
  EXPECT_EQ(0, help.exit_code);
  EXPECT_NE(std::string::npos, help.out.find("pilco_check FILE.json")) << help.out;
  EXPECT_EQ(1, run("/nowhere/values.json").exit_code);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
