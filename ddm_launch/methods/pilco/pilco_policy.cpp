// The policy that PILCO searches, on an observation, and where its first search starts.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco_policy.h"

#include <ddm_pilco/rbf_policy.h>

#include <Eigen/Eigenvalues>
#include <chrono>
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

PilcoPolicy::PilcoPolicy(std::shared_ptr<Observation> observation,
                         std::shared_ptr<pilco::SquashedPolicy> policy,
                         const std::vector<int>& angles)
    : observation_(std::move(observation)),
      policy_(std::move(policy)),
      features_(pilco::replaceAngles(static_cast<int>(observation_->names().size()), angles)) {}

Answer PilcoPolicy::answer() {
  const auto start = std::chrono::steady_clock::now();
  Answer answer;
  answer.torque = policy_->control(features_.value(x_));
  if (!answer.torque.allFinite()) answer.torque.setZero();
  answer.solve_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return answer;
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
