// Where policy search starts: the RBF policy of PILCO's first trial.
// SPDX-License-Identifier: BSD-3-Clause
#include "policy_start.h"

#include <ddm_pilco/rbf_policy.h>

#include <Eigen/Eigenvalues>
#include <utility>

namespace ddm {
namespace {

constexpr double kTargetStd = 0.1;  // of the published runs

Eigen::MatrixXd drawNormal(Eigen::Index rows, Eigen::Index cols, std::mt19937_64* rng) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(rows, cols);
  for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = normal(*rng);
  return out;
}

/// A with A A^T = covariance, which may be singular.
Eigen::MatrixXd squareRoot(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

std::shared_ptr<pilco::SquashedPolicy> makePilcoPolicy(int feature_dim, int num_centres,
                                                       const Eigen::VectorXd& max_torque) {
  auto network = std::make_unique<pilco::RbfPolicy>(
      feature_dim, static_cast<int>(max_torque.size()), num_centres);
  return std::make_shared<pilco::SquashedPolicy>(std::move(network), max_torque);
}

Eigen::VectorXd drawPolicyStart(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng) {
  const pilco::Moments start = features.predict(task.start);
  const Eigen::MatrixXd centres =
      (squareRoot(start.covariance) * drawNormal(start.mean.size(), num_centres, rng)).colwise() +
      start.mean;
  const Eigen::MatrixXd targets = kTargetStd * drawNormal(num_centres, torque_dim, rng);
  const Eigen::MatrixXd log_length_scales =
      task.policy_length_scales.array().log().matrix().replicate(1, torque_dim);
  return pilco::RbfPolicy::packParameters(log_length_scales, centres, targets);
}

}  // namespace ddm
