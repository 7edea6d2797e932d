// Tests of the pendulum: finer steps, goal, tip.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/pendulum.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ddm {
namespace {

Eigen::Vector2d stepOf(const PendulumOptions& options, const Eigen::Vector2d& state,
                       double torque) {
  Pendulum pendulum(options);
  pendulum.setState(state);
  pendulum.step(Eigen::VectorXd::Constant(1, torque));
  return pendulum.state();
}

/// Classical Runge-Kutta of order 4 with many equal steps, independent of the code under test.
Eigen::Vector2d referenceStep(const PendulumOptions& o, Eigen::Vector2d state, double torque) {
  const double inertia = o.mass * o.length * o.length / 3.0;
  const auto derivative = [&](const Eigen::Vector2d& x) -> Eigen::Vector2d {
    const double weight = o.mass * o.gravity * o.length * std::sin(x[0]) / 2.0;
    return {x[1], (torque - o.friction * x[1] - weight) / inertia};
  };
  constexpr int kSteps = 2000;
  const double h = o.dt / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector2d k1 = derivative(state);
    const Eigen::Vector2d k2 = derivative(state + h / 2 * k1);
    const Eigen::Vector2d k3 = derivative(state + h / 2 * k2);
    const Eigen::Vector2d k4 = derivative(state + h * k3);
    state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return state;
}

TEST(Pendulum, AgreesWithAReferenceIntegratorForEveryMassLengthFrictionAndStep) {
  for (const double friction : {0.0, 1e-9, 1e-4, 0.016, 0.3, 1.0, 20.0}) {
    for (const double length : {0.5, 1.0, 1.7}) {
      for (const double gravity : {0.0, 9.82}) {
        PendulumOptions options;
        options.friction = friction;
        options.length = length;
        options.mass = 1.3;
        options.dt = 0.15;
        options.gravity = gravity;
        const Eigen::Vector2d state(0.7, -1.1);
        const Eigen::Vector2d error =
            stepOf(options, state, 2.0) - referenceStep(options, state, 2.0);
        EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-9)
            << "friction " << friction << ", length " << length << ", gravity " << gravity;
      }
    }
  }
}

TEST(Pendulum, MeasuresTheDistanceToTheGoalTheShortWayRoundInDegrees) {
  const Pendulum pendulum{PendulumOptions()};
  constexpr double kDegree = kPi / 180;
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(0.0, 5.0)), 180.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(-kPi, 0.0)), 0.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(-kPi + 5 * kDegree, 0.0)), 5.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(41 * kPi - 8 * kDegree, 0.0)), 8.0, 1e-11);
}

TEST(Pendulum, LocatesTheTipOfTheRod) {
  PendulumOptions options;
  options.length = 2.0;
  const Pendulum pendulum(options);
  const auto tip = [&](double angle) {
    return pendulum.visiblePosition(Eigen::Vector2d(angle, 7.0));
  };
  EXPECT_LT((tip(0.0) - Eigen::Vector2d(0.0, -2.0)).norm(), 1e-15);     // hangs
  EXPECT_LT((tip(kPi / 2) - Eigen::Vector2d(2.0, 0.0)).norm(), 1e-15);  // points right
  EXPECT_LT((tip(kPi) - Eigen::Vector2d(0.0, 2.0)).norm(), 1e-15);      // up
  EXPECT_LT((tip(0.4) - tip(0.4 - 2 * kPi)).norm(), 1e-14);             // the same image
}

}  // namespace
}  // namespace ddm
