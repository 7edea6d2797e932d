// Tests of the pendulum: closed form, finer steps, energy, goal.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/pendulum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "ddm_sim/angles.h"

namespace ddm {
namespace {

PendulumOptions gravityOptions() {
  PendulumOptions options;
  options.gravity = 9.82;
  options.friction = 0.01;
  options.max_torque = {2.5};
  options.dt = 0.1;
  return options;
}

Eigen::Vector2d stepOf(const PendulumOptions& options, const Eigen::Vector2d& state,
                       double torque) {
  Pendulum pendulum(options);
  pendulum.setState(state);
  pendulum.step(Eigen::VectorXd::Constant(1, torque));
  return pendulum.state();
}

/// The same time in `parts` steps of a part of dt each.
Eigen::Vector2d finerStepOf(PendulumOptions options, int parts, const Eigen::Vector2d& state,
                            double torque) {
  options.dt /= parts;
  Pendulum pendulum(options);
  pendulum.setState(state);
  for (int i = 0; i < parts; ++i) pendulum.step(Eigen::VectorXd::Constant(1, torque));
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

/// Kinetic and potential energy [J].
double energy(const PendulumOptions& o, const Eigen::Vector2d& state) {
  return o.mass * o.length * o.length / 6.0 * state[1] * state[1] -
         o.mass * o.gravity * o.length / 2.0 * std::cos(state[0]);
}

TEST(Pendulum, StepsAsTheClosedFormOfThePaperSays) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(-6.0, 6.0);
  const double decay = std::exp(-0.6);
  for (int i = 0; i < 1000; ++i) {
    const double angle = uniform(engine);
    const double rate = uniform(engine);
    const double u = uniform(engine);
    const Eigen::Vector2d next = stepOf(PendulumOptions(), {angle, rate}, u);
    EXPECT_NEAR(next[0], angle + (rate - u) * (1 - decay) / 3 + 0.2 * u, 1e-12);
    EXPECT_NEAR(next[1], decay * rate + (1 - decay) * u, 1e-12);
  }
}

TEST(Pendulum, FollowsTheClosedFormOverAWholeTrial) {
  Pendulum pendulum{PendulumOptions()};
  Eigen::Vector2d expected(0.1, -0.2);
  pendulum.setState(expected);
  const double decay = std::exp(-0.6);
  for (int t = 0; t < 100; ++t) {
    const double u = 6.0 * std::sin(0.37 * t);
    pendulum.step(Eigen::VectorXd::Constant(1, u));
    expected = Eigen::Vector2d(expected[0] + (expected[1] - u) * (1 - decay) / 3 + 0.2 * u,
                               decay * expected[1] + (1 - decay) * u);
    ASSERT_LT((pendulum.state() - expected).cwiseAbs().maxCoeff(), 1e-9) << "step " << t;
  }
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

TEST(Pendulum, WithoutFrictionIsUniformlyAccelerated) {
  PendulumOptions options;
  options.friction = 0.0;  // I = 1/3, so u = 1 accelerates with 3 rad/s^2
  const Eigen::Vector2d next = stepOf(options, {1.0, 2.0}, 1.0);
  EXPECT_NEAR(next[0], 1.0 + 2.0 * 0.2 + 3.0 * 0.2 * 0.2 / 2.0, 1e-14);
  EXPECT_NEAR(next[1], 2.0 + 3.0 * 0.2, 1e-14);
}

TEST(Pendulum, IsContinuousWhereTheExactStepChangesItsFormula) {
  PendulumOptions below;
  below.friction = 1e-2 / 3.0 / 0.2 * (1 - 1e-12);
  PendulumOptions above = below;
  above.friction = 1e-2 / 3.0 / 0.2 * (1 + 1e-12);
  const Eigen::Vector2d state(0.0, 3.0);
  EXPECT_LT((stepOf(below, state, 6.0) - stepOf(above, state, 6.0)).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Pendulum, WithGravityAgreesWithStepsAHundredTimesFiner) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  std::uniform_real_distribution<double> rate(-10.0, 10.0);
  std::uniform_real_distribution<double> torque(-2.5, 2.5);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d state(angle(engine), rate(engine));
    const double u = torque(engine);
    const Eigen::Vector2d difference =
        stepOf(gravityOptions(), state, u) - finerStepOf(gravityOptions(), 100, state, u);
    ASSERT_LT(difference.cwiseAbs().maxCoeff(), 1e-9);  // the project's bar is 1e-6
  }
}

TEST(Pendulum, KeepsItsEnergyWithoutFrictionAndTorque) {
  PendulumOptions options = gravityOptions();
  options.friction = 0.0;
  Pendulum pendulum(options);
  pendulum.setState(Eigen::Vector2d(3.0, 0.5));
  const double at_start = energy(options, pendulum.state());
  double lowest_angle = 3.0;
  for (int t = 0; t < 1000; ++t) {
    pendulum.step(Eigen::VectorXd::Zero(1));
    lowest_angle = std::min(lowest_angle, pendulum.state()[0]);
    ASSERT_NEAR(energy(options, pendulum.state()), at_start, 1e-8) << "step " << t;
  }
  EXPECT_LT(lowest_angle, 0.0);  // it did swing through
}

TEST(Pendulum, LosesEnergyToFriction) {
  const PendulumOptions options = gravityOptions();
  const Eigen::Vector2d state(0.0, 4.0);
  EXPECT_LT(energy(options, stepOf(options, state, 0.0)), energy(options, state) - 1e-4);
}

TEST(Pendulum, WithGravityCannotBeLiftedDirectly) {
  Pendulum pendulum(gravityOptions());
  for (int t = 0; t < 100; ++t) {
    pendulum.step(Eigen::VectorXd::Constant(1, 2.5));
    ASSERT_GT(pendulum.goalError(pendulum.state()), 17.0) << "step " << t;
  }
}

TEST(Pendulum, NeverWrapsTheAngle) {
  Pendulum pendulum{PendulumOptions()};
  for (int t = 0; t < 100; ++t) pendulum.step(Eigen::VectorXd::Constant(1, 6.0));
  EXPECT_GT(pendulum.state()[0], 6.0 * kPi);
}

TEST(Pendulum, MeasuresTheDistanceToTheGoalTheShortWayRoundInDegrees) {
  const Pendulum pendulum{PendulumOptions()};
  constexpr double kDegree = kPi / 180;
  EXPECT_EQ(pendulum.goal(), Eigen::Vector2d(kPi, 0.0));
  EXPECT_EQ(pendulum.info().error_unit, "deg");
  EXPECT_EQ(pendulum.info().tolerance, 10.0);
  EXPECT_EQ(pendulum.goalError(pendulum.goal()), 0.0);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(0.0, 5.0)), 180.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(-kPi, 0.0)), 0.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(-kPi + 5 * kDegree, 0.0)), 5.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(kPi + 5 * kDegree, 0.0)), 5.0, 1e-12);
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(41 * kPi - 8 * kDegree, 0.0)), 8.0, 1e-11);
}

TEST(Pendulum, MeasuresTheDistanceToTheGoalOfThisTrial) {
  Pendulum pendulum{PendulumOptions()};
  pendulum.setGoal(Eigen::Vector2d(kPi / 2, 0.0));
  EXPECT_NEAR(pendulum.goalError(Eigen::Vector2d(kPi, 0.0)), 90.0, 1e-12);
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
  EXPECT_LT((tip(0.4) - tip(0.4 - 2 * kPi)).norm(), 1e-14);             // the picture is the same
}

TEST(Pendulum, NamesJointStateAndTorqueWithTheirUnits) {
  const PlantInfo info = Pendulum{PendulumOptions()}.info();
  ASSERT_EQ(info.joints.size(), 1U);
  EXPECT_EQ(info.joints[0].name, "pendulum");
  EXPECT_EQ(info.joints[0].kind, JointKind::kAngle);
  EXPECT_EQ(info.state_names, (std::vector<std::string>{"angle_rad", "rate_rad_per_s"}));
  EXPECT_EQ(info.torque_names, std::vector<std::string>{"torque_nm"});
}

TEST(Pendulum, RefusesOptionsWithAllTheirProblemsAtOnce) {
  PendulumOptions options;
  options.mass = 0.0;
  options.dt = -1.0;
  options.picture_size = 0;
  options.look.rod_half_width = 0.0;
  try {
    Pendulum pendulum(options);
    FAIL() << "a rod without mass was made";
  } catch (const std::invalid_argument& e) {
    const std::string message = e.what();
    for (const char* key :
         {"plant/mass", "plant/dt", "plant/picture_size", "plant/rod_half_width"}) {
      EXPECT_NE(message.find(key), std::string::npos) << message;
    }
  }
}

TEST(Pendulum, RefusesTwoLimitsForItsOneMotorByName) {
  PendulumOptions options;
  options.max_torque = {6.0, 6.0};
  try {
    Pendulum pendulum(options);
    FAIL() << "two limits were taken for one motor";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("plant/max_torque"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace ddm
