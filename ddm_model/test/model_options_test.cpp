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
  EXPECT_TRUE(refuses(with(&ModelOptions::pca_dim, 1001), "model/pca_dim", "1001"));
  EXPECT_TRUE(refuses(with(&ModelOptions::feature_dim, 0), "model/feature_dim", "0"));
  EXPECT_TRUE(refuses(with(&ModelOptions::feature_dim, 101), "model/feature_dim", "101"));
  EXPECT_TRUE(refuses(with(&ModelOptions::order, 0), "model/order", "0"));
  EXPECT_TRUE(refuses(with(&ModelOptions::order, 51), "model/order", "51"));
  EXPECT_TRUE(refuses(with(&ModelOptions::delay, -1), "model/delay", "-1"));
  EXPECT_TRUE(refuses(with(&ModelOptions::delay, 51), "model/delay", "51"));
  const std::vector<int> zero = {4, 0}, huge = {4097, 4};
  EXPECT_TRUE(refuses(with(&ModelOptions::encoder_widths, zero), "model/encoder_widths", "0"));
  EXPECT_TRUE(refuses(with(&ModelOptions::decoder_widths, huge), "model/decoder_widths", "4097"));
  EXPECT_TRUE(refuses(with(&ModelOptions::predictor_widths, zero), "model/predictor_widths", "0"));
  using Limits = std::vector<double>;
  const auto max_torque = [](const Limits& limits) {
    return with(&ModelOptions::max_torque, limits);
  };
  EXPECT_TRUE(refuses(max_torque({0.0}), "model/max_torque", "0"));
  EXPECT_TRUE(refuses(max_torque({kNaN}), "model/max_torque", "nan"));
  EXPECT_TRUE(refuses(max_torque({6.0, kInf}), "model/max_torque", "[6, inf]"));
  EXPECT_TRUE(refuses(max_torque({}), "model/max_torque", "[]"));
}

TEST(TrainingOptions, RefusesEachKeyOutOfRangeWithItsNameAndValue) {
  using Training = TrainingOptions;
  EXPECT_TRUE(refuses(with(&Training::solver, std::string("adam")), "training/solver", "adam"));
  EXPECT_TRUE(refuses(with(&Training::max_iterations, 0), "training/max_iterations", "0"));
  EXPECT_TRUE(
      refuses(with(&Training::function_tolerance, -1e-3), "training/function_tolerance", "-0.001"));
  EXPECT_TRUE(
      refuses(with(&Training::function_tolerance, 1.0), "training/function_tolerance", "1"));
  EXPECT_TRUE(
      refuses(with(&Training::function_tolerance, kNaN), "training/function_tolerance", "nan"));
  EXPECT_TRUE(refuses(with(&Training::selection_steps, -1), "training/selection_steps", "-1"));
  for (int bad : {-1, 7}) {  // with a single start
    EXPECT_TRUE(refuses(with(&Training::selection_iterations, bad), "training/selection_iterations",
                        std::to_string(bad)));
  }
  EXPECT_TRUE(refuses(with(&Training::prediction_steps, 0), "training/prediction_steps", "0"));
  EXPECT_TRUE(
      refuses(with(&Training::warm_up_iterations, -1), "training/warm_up_iterations", "-1"));
  EXPECT_TRUE(refuses(with(&Training::selection_steps, 4), "training/selection_steps", "4"));
  EXPECT_TRUE(refuses(with(&Training::weight_decay, -0.5), "training/weight_decay", "-0.5"));
  EXPECT_TRUE(refuses(with(&Training::weight_decay, kInf), "training/weight_decay", "inf"));
  EXPECT_TRUE(refuses(with(&Training::lbfgs_rank, 0), "training/lbfgs_rank", "0"));
  EXPECT_TRUE(refuses(with(&Training::lbfgs_rank, 1001), "training/lbfgs_rank", "1001"));
  for (double bad : {kNaN, kInf}) {
    const std::string text = bad > 0 ? "inf" : "nan";
    EXPECT_TRUE(refuses(with(&Training::score_std, bad), "training/score_std", text));
    EXPECT_TRUE(refuses(with(&Training::layer_std, bad), "training/layer_std", text));
    EXPECT_TRUE(refuses(with(&Training::predictor_gain, bad), "training/predictor_gain", text));
  }
  EXPECT_TRUE(refuses(with(&Training::score_std, 0.0), "training/score_std", "0"));
  EXPECT_TRUE(refuses(with(&Training::layer_std, -1.0), "training/layer_std", "-1"));
  EXPECT_TRUE(refuses(with(&Training::predictor_gain, -1.0), "training/predictor_gain", "-1"));
}

TEST(ModelOptions, AcceptsTheEdgesOfItsRanges) {
  for (int order : {1, 50}) EXPECT_TRUE(with(&ModelOptions::order, order).problems().empty());
  EXPECT_TRUE(with(&ModelOptions::encoder_widths, std::vector<int>()).problems().empty());
  EXPECT_TRUE(with(&TrainingOptions::function_tolerance, 0.0).problems().empty());
  EXPECT_TRUE(with(&TrainingOptions::predictor_gain, 0.0).problems().empty());
}

TEST(ModelOptions, ReportsAllProblemsAtOnce) {
  ModelOptions options;
  options.order = 0;
  options.encoder_widths = {0, -1};
  options.max_torque = {-6.0};
  EXPECT_EQ(options.problems().size(), 4U);
}

}  // namespace
}  // namespace ddm
