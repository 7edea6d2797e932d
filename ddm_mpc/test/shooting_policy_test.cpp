// Tests of the example of a policy: its torques are near the best ones, within the bound, and repeat.
// SPDX-License-Identifier: BSD-3-Clause
#include "../../examples/shooting_policy.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_model.h"

namespace ddm {
namespace {

constexpr double kMaxTorque = 6.0;

/// z_{t+1} = z_t + B u_t
std::shared_ptr<const Ddm> integrator() {
  RandomModelOptions options;
  options.model.order = 1;
  Eigen::MatrixXd A(2, 3);
  A << 1.0, 0.0, 0.2, 0.0, 1.0, -0.1;
  return std::make_shared<const Ddm>(linearModel(options, A, Eigen::VectorXd::Zero(2)));
}

/// The constant torque that minimises the policy's sum: of k B u to z_ref - z over all steps k.
double bestTorque(const Ddm& model, const Image& image) {
  History x(model.options().order, model.featureDim(), model.torqueDim());
  x.observe(model.encode(image));
  const Eigen::VectorXd z = model.predict(x, Eigen::VectorXd::Zero(1));
  const Eigen::VectorXd B = model.predict(x, Eigen::VectorXd::Ones(1)) - z;
  double sum_k = 0.0, sum_k2 = 0.0;
  for (int k = 1; k <= ShootingPolicy::kHorizon; ++k) {
    sum_k += k;
    sum_k2 += k * k;
  }
  const double u = sum_k * B.dot(model.goalFeature() - z) / (sum_k2 * B.squaredNorm());
  return std::max(-kMaxTorque, std::min(kMaxTorque, u));
}

TEST(ShootingPolicy, AnswersWithATorqueNearTheBestOneAndRepeatsIt) {
  const auto model = integrator();
  ShootingPolicy policy(model, kMaxTorque);
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Image image = randomImage(8, seed);
    const TrialId id{seed, 0, false};
    policy.startTrial(id);
    policy.observe(image);
    const Answer answer = policy.answer();
    ASSERT_EQ(answer.torque.size(), 1);
    EXPECT_LE(std::abs(answer.torque[0]), kMaxTorque);
    // the nearest of 100 torques drawn from 12 N m
    EXPECT_NEAR(answer.torque[0], bestTorque(*model, image), 1.0);
    policy.apply(answer.torque);
    policy.startTrial(id);
    policy.observe(image);
    EXPECT_EQ(policy.answer().torque, answer.torque);
  }
}

}  // namespace
}  // namespace ddm
