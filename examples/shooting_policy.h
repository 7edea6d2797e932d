// Example of a policy: random shooting in feature space.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>
#include <ddm_mpc/policy.h>

#include <memory>
#include <random>

/// Draws random torques u and applies the best one, argmin_u sum_{k=1}^{K} |z_{t+k|t} - z_ref|^2,
/// where u is held for K steps.
class ShootingPolicy : public ddm::Policy {
 public:
  static constexpr int kHorizon = 5, kNumSamples = 100;  // K, number of random torques

  /// @param model       model that contains a goal image
  /// @param max_torque  largest torque of each motor [N m]
  ShootingPolicy(const std::shared_ptr<const ddm::Ddm>& model, double max_torque)
      : model_(model),
        uniform_(-max_torque, max_torque),
        z_ref_(model->goalFeature()),
        x_(model->options().order, model->featureDim(), model->torqueDim()) {}

  void startTrial(const ddm::TrialId& id) override {
    x_.clear();
    // The same trial draws the same torques.
    rng_ = ddm::randomStream(id, ddm::StreamRole::kPlannerStarts);
  }
  void startSegment() override { x_.clear(); }
  void setGoal(const ddm::Image& goal) override { z_ref_ = model_->encode(goal); }
  void observe(const ddm::Image& image) override { x_.observe(model_->encode(image)); }
  void apply(const Eigen::VectorXd& u) override { x_.apply(u); }

  ddm::Answer answer() override {
    ddm::Answer best;
    double least = 0.0;
    for (int sample = 0; sample < kNumSamples; ++sample) {
      const Eigen::VectorXd u =
          Eigen::VectorXd::Zero(model_->torqueDim()).unaryExpr([this](double) {
            return uniform_(rng_);
          });
      ddm::History x = x_;
      double sum = 0.0;
      for (int k = 0; k < kHorizon; ++k) {
        const Eigen::VectorXd z = model_->predict(x, u);
        x.apply(u);
        x.observe(z);
        sum += (z - z_ref_).squaredNorm();
      }
      if (sample == 0 || sum < least) {
        best.torque = u;
        least = sum;
      }
    }
    return best;
  }

 private:
  std::shared_ptr<const ddm::Ddm> model_;
  std::uniform_real_distribution<double> uniform_;  // random torques [N m]
  Eigen::VectorXd z_ref_;
  ddm::History x_;
  std::mt19937_64 rng_;
};
