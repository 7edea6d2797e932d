// The policy that PILCO searches, on an observation, and where its first search starts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/policy.h>
#include <ddm_pilco/rbf_policy.h>
#include <ddm_pilco/squashed_policy.h>
#include <ddm_pilco/trigonometric.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "observations.h"

namespace ddm {

/// u = policy(features of x)
class PilcoPolicy : public Policy {
 public:
  /// @param angles  entries of x that are angles
  PilcoPolicy(std::shared_ptr<Observation> observation,
              std::shared_ptr<pilco::SquashedPolicy> policy, const std::vector<int>& angles)
      : observation_(std::move(observation)),
        policy_(std::move(policy)),
        features_(pilco::replaceAngles(static_cast<int>(observation_->names().size()), angles)) {}

  void startTrial(const TrialId& id) override { observation_->startTrial(id); }
  void observe(const Grey& grey) override { x_ = observation_->observe(grey); }
  /// 0 where the policy's torque is not finite.
  Answer answer() override {
    const auto start = std::chrono::steady_clock::now();
    Answer answer;
    answer.torque = policy_->control(features_.value(x_));
    if (!answer.torque.allFinite()) answer.torque.setZero();
    answer.solve_time =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return answer;
  }

  void apply(const Eigen::VectorXd& /*u*/) override {}

 private:
  std::shared_ptr<Observation> observation_;
  std::shared_ptr<pilco::SquashedPolicy> policy_;
  pilco::Augmentation features_;
  Eigen::VectorXd x_;
};

/// Parameters of the RBF policy of PILCO's first trial: centres drawn from the features of the
/// start distribution, which is taken as Gaussian, small random targets, length-scales of the task.
/// @param features  of the task's state
inline Eigen::VectorXd drawPolicyStart(const PilcoTask& task, const pilco::Augmentation& features,
                                       int num_centres, int torque_dim, std::mt19937_64* rng) {
  constexpr double kTargetStd = 0.1;  // of the published runs
  const auto drawNormal = [rng](Eigen::Index rows, Eigen::Index cols) {
    std::normal_distribution<double> normal;
    Eigen::MatrixXd out(rows, cols);
    for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = normal(*rng);
    return out;
  };
  const pilco::Moments start = features.predict(task.start);
  // A root of the covariance, which may be singular.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(start.covariance);
  const Eigen::MatrixXd root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd centres =
      (root * drawNormal(start.mean.size(), num_centres)).colwise() + start.mean;
  const Eigen::MatrixXd targets = kTargetStd * drawNormal(num_centres, torque_dim);
  const Eigen::MatrixXd log_length_scales =
      task.policy_length_scales.array().log().matrix().replicate(1, torque_dim);
  return pilco::RbfPolicy::packParameters(log_length_scales, centres, targets);
}

}  // namespace ddm
