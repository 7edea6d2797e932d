// Small models with random parameters, images and states to go with them, and plans with them, for tests.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>
#include <ddm_model/testing/gradient_check.h>
#include <ddm_model/testing/random_matrix.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <functional>
#include <random>

#include "ddm_mpc/ddm_plan_cost.h"
#include "ddm_mpc/planner.h"

namespace ddm {
/// Random grey values.
inline Image randomImage(int image_size, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_int_distribution<int> byte(0, 255);
  Image image(static_cast<std::size_t>(image_size) * image_size);
  for (std::uint8_t& k : image) k = static_cast<std::uint8_t>(byte(rng));
  return image;
}

/// What a test wants of its model.
struct RandomModelOptions {
  int image_size = 8;
  int torque_dim = 1;
  bool goal = true;
  double gain = 1.0;  ///< of f: its weights and biases are N(0, gain^2)
  unsigned seed = 1;
  ModelOptions model;

  RandomModelOptions() {
    model.pca_dim = 5;
    model.encoder_widths = {4};
  }
};

/// A model with an orthonormal random basis and random parameters.
inline Ddm randomModel(const RandomModelOptions& options) {
  const Networks<double> networks(options.model, options.torque_dim);
  const Eigen::Index num_pixels = options.image_size * options.image_size;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(
      testing::randomMatrix(num_pixels, options.model.pca_dim, options.seed));
  const Eigen::MatrixXd basis =
      qr.householderQ() * Eigen::MatrixXd::Identity(num_pixels, options.model.pca_dim);
  Pca pca;
  pca.mean = Eigen::VectorXf::Constant(num_pixels, 0.5F);
  pca.basis = basis.cast<float>();
  pca.variance = Eigen::VectorXd::Ones(options.model.pca_dim);
  Eigen::VectorXd theta = testing::randomMatrix(networks.numParams(), 1, options.seed + 1);
  theta.tail(networks.f().numParams()) *= options.gain;
  Image goal;
  if (options.goal) goal = randomImage(options.image_size, options.seed + 2);
  return Ddm(options.model, options.image_size, options.torque_dim, pca, theta, goal, ModelInfo());
}

/// The model with other information about its training.
inline Ddm withInfo(const Ddm& model, const ModelInfo& info) {
  return Ddm(model.options(), model.imageSize(), model.torqueDim(), model.pca(), model.theta(),
             model.goal(), info);
}

/// The model with random support states.
inline Ddm withSupportStates(const Ddm& model, int count) {
  ModelInfo info;  // z_t, z_{t-1}, u_{t-1} of each
  const int dim = model.featureDim() + model.featureDim() + model.torqueDim();
  info.support_states = testing::randomMatrix(dim, count, 7).cast<float>();
  return withInfo(model, info);
}

/// A model with f(h) = A h + b, no hidden layer: z_{t+1} = A h_t + b.
/// @param A  [feature_dim x order (feature_dim + torque_dim)]
inline Ddm linearModel(RandomModelOptions options, const Eigen::MatrixXd& A,
                       const Eigen::VectorXd& b) {
  options.model.predictor_widths.clear();
  const Ddm random = randomModel(options);
  Eigen::VectorXd theta = random.theta();
  theta.tail(A.size() + b.size()) << Eigen::Map<const Eigen::VectorXd>(A.data(), A.size()), b;
  return Ddm(options.model, options.image_size, options.torque_dim, random.pca(), theta,
             random.goal(), ModelInfo());
}

/// A state in the middle of a trial, with features and torques that differ from step to step.
inline History randomHistory(const Ddm& model, unsigned seed) {
  History x(model.options().order, model.featureDim(), model.torqueDim());
  for (int step = 0; step < model.options().order; ++step) {
    x.observe(0.5 * testing::randomMatrix(model.featureDim(), 1, seed + 2 * step));
    if (step + 1 < model.options().order)
      x.apply(testing::randomMatrix(model.torqueDim(), 1, seed + 2 * step + 1));
  }
  return x;
}

/// Compares dJ/dU with differences.
inline ::testing::AssertionResult gradientMatches(DdmPlanCost* cost, const Eigen::MatrixXd& U,
                                                  double tolerance = 1e-6) {
  const auto f = [&](const Eigen::VectorXd& u, Eigen::VectorXd* gradient) {
    Eigen::MatrixXd d_U;
    const double value =
        cost->evaluate(Eigen::Map<const Eigen::MatrixXd>(u.data(), U.rows(), U.cols()),
                       gradient != nullptr ? &d_U : nullptr);
    if (gradient != nullptr) *gradient = Eigen::Map<const Eigen::VectorXd>(d_U.data(), d_U.size());
    return value;
  };
  return testing::gradientMatches(f, Eigen::Map<const Eigen::VectorXd>(U.data(), U.size()),
                                  tolerance);
}

/// Plans with a deep dynamical model from any state to any goal, as MpcPolicy does.
class ModelPlanner {
 public:
  ModelPlanner(const Ddm& model, const MpcOptions& options)
      : cost_(model, options.horizon, options.control_weight), planner_(&cost_, options) {}

  Plan solve(const History& x, const Eigen::VectorXd& goal_feature, std::mt19937_64* rng,
             const std::function<bool()>& stop = {}) {
    cost_.setProblem(x, goal_feature);
    return planner_.solve(rng, stop);
  }
  void clear() { planner_.clear(); }

 private:
  DdmPlanCost cost_;
  Planner planner_;
};

}  // namespace ddm
