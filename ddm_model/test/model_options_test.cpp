// Tests of the rules of the blocks model and training.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/model_options.h"

#include <gtest/gtest.h>

#include <limits>

#include "ddm_msgs/testing/not_finite.h"

namespace ddm {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Whether exactly one problem is found, about `key`, with the value that was given.
template <class Options>
::testing::AssertionResult refuses(const Options& options, const std::string& key,
                                   const std::string& value) {
  const std::vector<std::string> problems = options.problems();
  if (problems.size() != 1) {
    return ::testing::AssertionFailure() << problems.size() << " problems where one is due";
  }
  const std::string& text = problems.front();
  const std::string end = ", got " + value;
  if (text.rfind(key + " must ", 0) == 0 && text.size() > end.size() &&
      text.compare(text.size() - end.size(), end.size(), end) == 0) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << text;
}

template <class Options, class Value>
Options with(Value Options::*member, Value value) {
  Options options;
  options.*member = value;
  return options;
}

TEST(ModelOptions, DefaultsAreValidAndThePapers) {
  EXPECT_TRUE(ModelOptions{}.problems().empty());
  EXPECT_TRUE(TrainingOptions{}.problems().empty());
  EXPECT_EQ(ModelOptions{}.pca_dim, 50);
  EXPECT_EQ(ModelOptions{}.encoder_widths, (std::vector<int>{25, 12, 6}));
}

TEST(ModelOptions, RefusesEachKeyOutOfRangeWithItsNameAndValue) {
  EXPECT_TRUE(refuses(with(&ModelOptions::pca_dim, 0), "model/pca_dim", "0"));
  EXPECT_TRUE(refuses(with(&ModelOptions::feature_dim, 101), "model/feature_dim", "101"));
  EXPECT_TRUE(refuses(with(&ModelOptions::order, 0), "model/order", "0"));
  EXPECT_TRUE(refuses(with(&ModelOptions::delay, -1), "model/delay", "-1"));
  const std::vector<int> zero = {4, 0}, huge = {4097, 4};
  EXPECT_TRUE(refuses(with(&ModelOptions::encoder_widths, zero), "model/encoder_widths", "0"));
  EXPECT_TRUE(refuses(with(&ModelOptions::encoder_widths, huge), "model/encoder_widths", "4097"));
  EXPECT_TRUE(refuses(with(&ModelOptions::predictor_widths, zero), "model/predictor_widths", "0"));
  using Limits = std::vector<double>;
  const auto max_torque = [](const Limits& limits) {
    return with(&ModelOptions::max_torque, limits);
  };
  EXPECT_TRUE(refuses(max_torque({6.0, kInf}), "model/max_torque", "[6, inf]"));
  EXPECT_TRUE(refuses(max_torque({}), "model/max_torque", "[]"));
}

TEST(TrainingOptions, RefusesEachKeyOutOfRangeWithItsNameAndValue) {
  using Training = TrainingOptions;
  EXPECT_TRUE(refuses(with(&Training::solver, std::string("adam")), "training/solver", "adam"));
  EXPECT_TRUE(refuses(with(&Training::max_iterations, 0), "training/max_iterations", "0"));
  EXPECT_TRUE(
      refuses(with(&Training::function_tolerance, kNaN), "training/function_tolerance", "nan"));
  EXPECT_TRUE(refuses(with(&Training::selection_iterations, 7), "training/selection_iterations",
                      "7"));  // with a single start
  EXPECT_TRUE(refuses(with(&Training::selection_steps, 4), "training/selection_steps", "4"));
  EXPECT_TRUE(refuses(with(&Training::prediction_steps, 0), "training/prediction_steps", "0"));
  EXPECT_TRUE(
      refuses(with(&Training::warm_up_iterations, -1), "training/warm_up_iterations", "-1"));
  EXPECT_TRUE(refuses(with(&Training::weight_decay, -0.5), "training/weight_decay", "-0.5"));
  EXPECT_TRUE(refuses(with(&Training::lbfgs_rank, 0), "training/lbfgs_rank", "0"));
}

}  // namespace
}  // namespace ddm
