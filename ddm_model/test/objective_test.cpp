// Tests of the joint objective V_R + V_P: the formula, the gradient, the borders of segments.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/objective.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <stdexcept>
#include <tuple>

#include "ddm_model/testing/gradient_check.h"
#include "ddm_model/testing/random_matrix.h"
#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

using testing::randomMatrix;

ModelOptions tinyOptions() {
  ModelOptions options;
  options.pca_dim = 4;
  options.encoder_widths = {3};
  options.predictor_widths = {3};
  return options;
}

/// Random scores and torques [N m]; frames that are in no segment are allowed.
TrainingData<double> randomData(int pca_dim, int torque_dim, int num_frames, bool with_goal,
                                std::vector<Segment> segments) {
  TrainingData<double> data;
  data.scores = randomMatrix(pca_dim, num_frames + (with_goal ? 1 : 0), 1);
  data.torques = 6.0 * randomMatrix(torque_dim, num_frames, 2);
  data.segments = std::move(segments);
  return data;
}

Eigen::VectorXd applied(const Mlp<double>& net, const double* theta, const Eigen::VectorXd& input) {
  Mlp<double>::Tape tape;
  net.forward(theta, input, &tape);
  return tape.output();
}

/// V_R and V_P straight from the formula: one image at a time, segment by segment.
/// @param form  of f: only its flags count
JointObjective<double>::Value slowValue(const Networks<double>& nets,
                                        const TrainingData<double>& data,
                                        const Eigen::VectorXd& theta, const Terms& terms = Terms(),
                                        const ModelOptions& form = ModelOptions()) {
  const auto z = [&](Eigen::Index t) {
    return applied(nets.encoder(), nets.encoderOf(theta.data()), data.scores.col(t));
  };
  const auto decoded = [&](const Eigen::VectorXd& feature) {
    return applied(nets.decoder(), nets.decoderOf(theta.data()), feature);
  };
  JointObjective<double>::Value value;
  for (Eigen::Index t = 0; t < data.scores.cols(); ++t) {
    value.v_r += (data.scores.col(t) - decoded(z(t))).squaredNorm();
  }
  const int n = nets.prediction_model.order();
  for (const Segment& segment : data.segments) {
    const Eigen::Index end = segment.begin + segment.size;
    for (Eigen::Index t = segment.begin + n - 1; t + 1 < end; ++t) {
      std::vector<Eigen::VectorXd> path;  // z_{t-n+1} ... z_t, then the predictions
      for (Eigen::Index i = t - n + 1; i <= t; ++i) path.push_back(z(i));
      for (int j = 1; j <= terms.prediction_steps && t + j < end; ++j) {
        Eigen::VectorXd h(0);
        for (int lag = 0; lag < n; ++lag) {
          Eigen::VectorXd feature = path[path.size() - 1 - static_cast<size_t>(lag)];
          if (form.featureDifferences() && lag == 1) feature = path.back() - feature;
          if (form.featureDifferences() && lag > 1) feature.resize(0);
          const Eigen::VectorXd torque =
              data.torques.col(t + j - 1 - lag).cwiseQuotient(nets.prediction_model.maxTorque());
          Eigen::VectorXd longer(h.size() + feature.size() + torque.size());
          longer << h, feature, torque;
          h = longer;
        }
        Eigen::VectorXd predicted = applied(nets.f(), nets.predictorOf(theta.data()), h);
        if (form.featureDifferences()) predicted += path.back();
        value.v_p +=
            (data.scores.col(t + j) - decoded(predicted)).squaredNorm() / terms.prediction_steps;
        path.push_back(predicted);
      }
    }
  }
  return value;
}

/// What some terms come to as a function of theta.
DifferentiableFunction singleTerm(JointObjective<double>* objective, Terms terms) {
  return [objective, terms](const Eigen::VectorXd& theta, Eigen::VectorXd* gradient) {
    const auto value = objective->evaluate(theta, gradient, terms);
    return value.of(terms);
  };
}

/// A network f for features and for their differences.
std::vector<ModelOptions> formsOfF(int order) {
  std::vector<ModelOptions> forms;
  for (const char* predictor : {"network", "gp"}) {
    forms.push_back(tinyOptions());
    forms.back().order = order;
    forms.back().predictor = predictor;
  }
  return forms;
}

TEST(JointObjective, EqualsTheFormulaForOneAndSeveralStepsAcrossTheBordersOfItsParts) {
  for (const int order : {1, 3}) {
    for (const ModelOptions& options : formsOfF(order)) {
      for (const int steps : {1, 5}) {
        const Networks<double> nets(options, 2);
        // The second segment is shorter than the longest prediction; the last one crosses two parts.
        const auto data = randomData(4, 2, 300, true, {{0, 7}, {7, 4}, {11, 1}, {12, 288}});
        JointObjective<double> objective(nets, data);
        const Eigen::VectorXd theta = 0.5 * randomMatrix(nets.numParams(), 1, 3);
        Terms terms;
        terms.prediction_steps = steps;
        const auto value = objective.evaluate(theta, nullptr, terms);
        const auto slow = slowValue(nets, data, theta, terms, options);
        EXPECT_NEAR(value.v_r, slow.v_r, 1e-11 * slow.v_r) << order << ", " << steps << " steps";
        EXPECT_NEAR(value.v_p, slow.v_p, 1e-11 * slow.v_p) << order << ", " << steps << " steps";
      }
    }
  }
}

TEST(JointObjective, GradientOfSeveralStepsMatchesDifferences) {
  for (const int order : {1, 3}) {
    for (const ModelOptions& options : formsOfF(order)) {
      const Networks<double> nets(options, 2);
      JointObjective<double> objective(nets,
                                       randomData(4, 2, 24, true, {{0, 9}, {9, 5}, {14, 10}}));
      Terms terms;
      terms.prediction_steps = 4;
      EXPECT_TRUE(testing::gradientMatches(singleTerm(&objective, terms),
                                           0.5 * randomMatrix(nets.numParams(), 1, 3)))
          << "order " << order << ", " << options.predictor;
    }
  }
}

TEST(JointObjective, WeightDecayCountsTheSquaredWeightsOfAllNetworksAndNoBias) {
  const Networks<double> nets(tinyOptions(), 1);
  JointObjective<double> objective(nets, randomData(4, 1, 20, true, {{0, 20}}));
  Eigen::VectorXd theta = randomMatrix(nets.numParams(), 1, 3);
  double expected = 0.0;
  const auto square = [&expected](const Mlp<double>& net, double* part) {
    for (int layer = 0; layer < net.numLayers(); ++layer) {
      expected += net.weights(part, layer).array().square().sum();
      net.biases(part, layer).setConstant(5.0);
    }
  };
  square(nets.encoder(), nets.encoderOf(theta.data()));
  square(nets.decoder(), nets.decoderOf(theta.data()));
  square(nets.f(), nets.predictorOf(theta.data()));
  Terms terms;
  terms.weight_decay = 3.0;
  const auto value = objective.evaluate(theta, nullptr, terms);
  EXPECT_NEAR(value.v_w, expected, 1e-12 * expected);
  EXPECT_NEAR(value.of(terms), value.v_r + value.v_p + 3.0 * expected, 1e-9 * expected);
  EXPECT_EQ(value.of(Terms()), value.v_r + value.v_p);
}

TEST(JointObjective, GradientOfEachTermAloneAndWithWeightDecayMatchesDifferences) {
  const Networks<double> nets(tinyOptions(), 1);
  JointObjective<double> objective(nets, randomData(4, 1, 140, true, {{0, 5}, {5, 135}}));
  const Eigen::VectorXd theta = randomMatrix(nets.numParams(), 1, 3);
  EXPECT_TRUE(testing::gradientMatches(singleTerm(&objective, {true, false}), theta));
  EXPECT_TRUE(testing::gradientMatches(singleTerm(&objective, {false, true}), theta));
  EXPECT_TRUE(testing::gradientMatches(singleTerm(&objective, {true, true, 1, 0.3}), theta));
}

TEST(JointObjective, TheNumberOfProcessorsChangesNoBit) {
  const Networks<float> nets(tinyOptions(), 1);
  const auto data = randomData(4, 1, 1500, true, {{0, 700}, {700, 800}});  // twelve parts
  JointObjective<float> objective(nets, {data.scores.cast<float>(), data.torques, data.segments});
  const Eigen::VectorXf theta = randomMatrix(nets.numParams(), 1, 3).cast<float>();
  const auto flat = [](const Eigen::MatrixXf& matrix) {
    return Eigen::Map<const Eigen::VectorXf>(matrix.data(), matrix.size()).eval();
  };
  const auto onProcessors = [&](int number) {
    omp_set_num_threads(number);
    Eigen::VectorXf all;  // values, gradient and factors one after the other
    const auto value = objective.evaluate(theta, &all);
    std::mt19937_64 rng(1);
    for (const auto& layer : objective.factors(theta, Terms(), &rng)) {
      const Eigen::VectorXf before = all;
      all.resize(before.size() + layer.inputs.size() + layer.errors.size());
      all << before, flat(layer.inputs), flat(layer.errors);
    }
    return std::make_tuple(value.v_r, value.v_p, all);
  };
  const int usual = omp_get_max_threads();
  const auto one = onProcessors(1);
  EXPECT_EQ(onProcessors(2), one);
  omp_set_num_threads(usual);
}

TEST(JointObjective, SinglePrecisionAgreesWithDouble) {
  const Networks<double> nets(tinyOptions(), 1);
  const Networks<float> nets_single(tinyOptions(), 1);
  const auto data = randomData(4, 1, 200, true, {{0, 200}});
  TrainingData<float> single{data.scores.cast<float>(), data.torques, data.segments};
  const Eigen::VectorXd theta = randomMatrix(nets.numParams(), 1, 3);
  Eigen::VectorXd gradient;
  Eigen::VectorXf gradient_single;
  const auto value = JointObjective<double>(nets, data).evaluate(theta, &gradient);
  const auto value_single =
      JointObjective<float>(nets_single, single).evaluate(theta.cast<float>(), &gradient_single);
  EXPECT_NEAR(value_single.v_r / value.v_r, 1.0, 1e-5);
  EXPECT_NEAR(value_single.v_p / value.v_p, 1.0, 1e-5);
  EXPECT_TRUE(gradient_single.cast<double>().isApprox(gradient, 1e-4));
}

TEST(JointObjective, NamesWhatPredictionsNeedWhereNoSegmentIsLongEnough) {
  const Networks<double> nets(tinyOptions(), 1);
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&] {
        JointObjective<double>(nets, randomData(4, 1, 6, true, {{0, 2}, {2, 2}, {4, 1}}))
            .requirePredictions();
      },
      {"model/order", "= 2 frames"}));
}

}  // namespace
}  // namespace ddm
