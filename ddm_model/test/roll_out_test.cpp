// Tests of predictions over several steps by a Gaussian process; objective_test.cpp covers networks.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/roll_out.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ddm_model/testing/gradient_check.h"
#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace {

using testing::randomMatrix;

constexpr int kFrames = 12;
constexpr int kSteps = 4;
const std::vector<Eigen::Index> kTargets = {4, 5, 8};

RollOut<double>::Targets targets() { return {kTargets.data(), 3}; }

/// With a Gaussian process in f, the rollout is z_{t+1} = z_t + S h + b + sum_i w_i
/// exp(-|h / l - c_i|^2 / 2).
class RollOutOfAGaussianProcess : public ::testing::Test {
 protected:
  static ModelOptions options() {
    ModelOptions options;
    options.order = 3;
    options.max_torque = {1.5, 0.5};
    options.predictor = "gp";
    return options;
  }

  const PredictionModel<double> f_{options(), 2, /*num_centres=*/5};
  const Eigen::VectorXd theta_p_ = 0.7 * randomMatrix(f_.numParams(), 1, 1);
  const Eigen::MatrixXd Z_ = randomMatrix(2, kFrames, 2);
  const Eigen::MatrixXd U_ = randomMatrix(2, kFrames, 3);
};

TEST_F(RollOutOfAGaussianProcess, EqualsTheFormula) {
  RollOut<double> roll_out(f_);
  roll_out.forward(theta_p_.data(), Z_, U_, targets(), kSteps);
  const Eigen::Map<const Eigen::VectorXd> inverse_scales(theta_p_.data(), 10);
  const Eigen::Map<const Eigen::MatrixXd> slope(theta_p_.data() + 10, 2, 10);
  const Eigen::Map<const Eigen::Vector2d> bias(theta_p_.data() + 30);
  const Eigen::Map<const Eigen::MatrixXd> centres(theta_p_.data() + 32, 10, 5);
  const Eigen::Map<const Eigen::MatrixXd> weights(theta_p_.data() + 82, 2, 5);
  for (int i = 0; i < 3; ++i) {
    Eigen::MatrixXd path = Z_;
    for (Eigen::Index t = kTargets[i]; t < kTargets[i] + kSteps; ++t) {
      Eigen::VectorXd h(10);
      h << path.col(t - 1), U_.col(t - 1).cwiseQuotient(f_.maxTorque()),
          path.col(t - 1) - path.col(t - 2), U_.col(t - 2).cwiseQuotient(f_.maxTorque()),
          U_.col(t - 3).cwiseQuotient(f_.maxTorque());
      Eigen::VectorXd change = slope * h + bias;
      for (int centre = 0; centre < 5; ++centre) {
        const Eigen::VectorXd distance = h.cwiseProduct(inverse_scales) - centres.col(centre);
        change += weights.col(centre) * std::exp(-0.5 * distance.squaredNorm());
      }
      const Eigen::VectorXd before = path.col(t - 1);
      path.col(t) = before + change;
      EXPECT_TRUE(roll_out.predicted(static_cast<int>(t - kTargets[i]))
                      .col(i)
                      .isApprox(path.col(t), 1e-12));
    }
  }
}

TEST_F(RollOutOfAGaussianProcess, GradientMatchesDifferencesForFeaturesAndTorques) {
  const Eigen::MatrixXd weight = randomMatrix(2, 3 * kSteps, 5);
  RollOut<double> roll_out(f_);
  const auto weighted_sum = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Eigen::Map<const Eigen::MatrixXd> Z(x.data(), 2, kFrames);
    const Eigen::Map<const Eigen::MatrixXd> U(x.data() + Z.size(), 2, kFrames);
    roll_out.forward(theta_p_.data(), Z, U, targets(), kSteps);
    double sum = 0.0;
    for (int step = 0; step < kSteps; ++step) {
      sum += roll_out.predicted(step).cwiseProduct(weight.middleCols(3 * step, 3)).sum();
      roll_out.dPredicted(step) = weight.middleCols(3 * step, 3);
    }
    if (gradient == nullptr) return sum;
    Eigen::MatrixXd d_Z = Eigen::MatrixXd::Zero(2, kFrames), d_U = d_Z;
    for (int step = kSteps - 1; step >= 0; --step) {
      roll_out.backward(theta_p_.data(), targets(), step, nullptr, &d_Z, &d_U);
    }
    gradient->resize(x.size());
    *gradient << Eigen::Map<Eigen::VectorXd>(d_Z.data(), d_Z.size()),
        Eigen::Map<Eigen::VectorXd>(d_U.data(), d_U.size());
    return sum;
  };
  Eigen::VectorXd x(Z_.size() + U_.size());
  x << Eigen::Map<const Eigen::VectorXd>(Z_.data(), Z_.size()),
      Eigen::Map<const Eigen::VectorXd>(U_.data(), U_.size());
  EXPECT_TRUE(testing::gradientMatches(weighted_sum, x));
}

TEST_F(RollOutOfAGaussianProcess, BeyondTheLastTorqueRepeatsIt) {
  RollOut<double> cut(f_), whole(f_);
  Eigen::MatrixXd U = U_;
  U.rightCols(kFrames - 9).colwise() = U_.col(8);
  cut.forward(theta_p_.data(), Z_, U_.leftCols(9), targets(), kSteps);
  whole.forward(theta_p_.data(), Z_, U, targets(), kSteps);
  EXPECT_EQ(cut.predicted(kSteps - 1), whole.predicted(kSteps - 1));
}

}  // namespace
}  // namespace ddm
