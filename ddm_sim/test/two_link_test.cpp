// Tests of the arm: an independent integrator, energy, limits that are known, goal and picture.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/two_link.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "ddm_sim/angles.h"
#include "ddm_sim/pendulum.h"

namespace ddm {
namespace {

/// Links that differ in everything, so that no two terms of the equations are mixed up unseen.
TwoLinkOptions lopsided() {
  TwoLinkOptions options;
  options.gravity = 9.82;
  options.length = {0.6, 0.35};
  options.mass = {1.3, 0.8};
  options.friction = {0.4, 0.07};
  options.dt = 0.15;
  return options;
}

Eigen::Vector4d stepOf(const TwoLinkOptions& options, const Eigen::Vector4d& state,
                       const Eigen::Vector2d& torque) {
  TwoLink arm(options);
  arm.setState(state);
  arm.step(torque);
  return arm.state();
}

/// Euler-Lagrange in the absolute angles (a, b) of both links, which is not the formula of the code
/// under test:
///
///   T = (m_1 / 3 + m_2) l_1^2 a'^2 / 2 + m_2 l_2^2 b'^2 / 6 + m_2 l_1 l_2 cos(a - b) a' b' / 2
///   V = -g (m_1 / 2 + m_2) l_1 cos a - g m_2 l_2 cos(b) / 2
///
/// The elbow's torque and friction act on the lower link, and against them on the upper one.
class Reference {
 public:
  explicit Reference(const TwoLinkOptions& o)
      : o_(o),
        upper_((o.mass[0] / 3 + o.mass[1]) * o.length[0] * o.length[0]),
        lower_(o.mass[1] * o.length[1] * o.length[1] / 3),
        coupling_(o.mass[1] * o.length[0] * o.length[1] / 2),
        weight_a_(o.gravity * (o.mass[0] / 2 + o.mass[1]) * o.length[0]),
        weight_b_(o.gravity * o.mass[1] * o.length[1] / 2) {}

  /// Kinetic and potential energy [J].
  double energy(const Eigen::Vector4d& state) const {
    const Eigen::Vector4d x = absolute(state);
    return upper_ * x[2] * x[2] / 2 + lower_ * x[3] * x[3] / 2 +
           coupling_ * std::cos(x[0] - x[1]) * x[2] * x[3] - weight_a_ * std::cos(x[0]) -
           weight_b_ * std::cos(x[1]);
  }

  /// Classical Runge-Kutta of order 4 with many equal steps.
  Eigen::Vector4d step(const Eigen::Vector4d& state, const Eigen::Vector2d& torque) const {
    constexpr int kSteps = 2000;
    const double h = o_.dt / kSteps;
    Eigen::Vector4d x = absolute(state);
    for (int i = 0; i < kSteps; ++i) {
      const Eigen::Vector4d k1 = derivative(x, torque);
      const Eigen::Vector4d k2 = derivative(x + h / 2 * k1, torque);
      const Eigen::Vector4d k3 = derivative(x + h / 2 * k2, torque);
      const Eigen::Vector4d k4 = derivative(x + h * k3, torque);
      x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return {x[0], x[1] - x[0], x[2], x[3] - x[2]};
  }

 private:
  static Eigen::Vector4d absolute(const Eigen::Vector4d& state) {
    return {state[0], state[0] + state[1], state[2], state[2] + state[3]};
  }

  Eigen::Vector4d derivative(const Eigen::Vector4d& x, const Eigen::Vector2d& torque) const {
    const double shoulder = torque[0] - o_.friction[0] * x[2];
    const double elbow = torque[1] - o_.friction[1] * (x[3] - x[2]);
    const double sine = coupling_ * std::sin(x[0] - x[1]);
    Eigen::Matrix2d inertia;
    inertia << upper_, coupling_ * std::cos(x[0] - x[1]),  //
        coupling_ * std::cos(x[0] - x[1]), lower_;
    const Eigen::Vector2d forces(shoulder - elbow - sine * x[3] * x[3] - weight_a_ * std::sin(x[0]),
                                 elbow + sine * x[2] * x[2] - weight_b_ * std::sin(x[1]));
    const Eigen::Vector2d acceleration = inertia.fullPivLu().solve(forces);
    return {x[2], x[3], acceleration[0], acceleration[1]};
  }

  TwoLinkOptions o_;
  double upper_, lower_, coupling_;  ///< of the inertia matrix [kg m^2]
  double weight_a_, weight_b_;       ///< [N m]
};

TEST(TwoLink, AgreesWithAReferenceIntegratorInOtherCoordinates) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  TwoLinkOptions without_gravity = lopsided();
  without_gravity.gravity = 0.0;
  TwoLinkOptions long_lower_link = lopsided();
  long_lower_link.length = {0.3, 0.9};
  long_lower_link.mass = {0.5, 2.0};
  for (const TwoLinkOptions& options :
       {lopsided(), without_gravity, long_lower_link, TwoLinkOptions()}) {
    const Reference reference(options);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector4d state(4 * uniform(engine), 4 * uniform(engine), 3 * uniform(engine),
                                  6 * uniform(engine));
      const Eigen::Vector2d torque(4 * uniform(engine), 2 * uniform(engine));
      const Eigen::Vector4d error = stepOf(options, state, torque) - reference.step(state, torque);
      ASSERT_LT(error.cwiseAbs().maxCoeff(), 1e-8) << state.transpose();
    }
  }
}

TEST(TwoLink, AgreesWithItselfInStepsAHundredTimesFiner) {
  TwoLink arm(lopsided());
  arm.setState(Eigen::Vector4d(3.0, -1.0, 2.0, -4.0));
  const Eigen::Vector2d torque(1.0, -0.5);
  TwoLinkOptions fine = lopsided();
  fine.dt /= 100;
  TwoLink finer(fine);
  finer.setState(arm.state());
  arm.step(torque);
  for (int i = 0; i < 100; ++i) finer.step(torque);
  EXPECT_LT((arm.state() - finer.state()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(TwoLink, KeepsItsEnergyWithoutFrictionAndTorque) {
  for (const double gravity : {0.0, 9.82}) {
    TwoLinkOptions options = lopsided();
    options.gravity = gravity;
    options.friction = {0.0, 0.0};
    const Reference reference(options);
    TwoLink arm(options);
    arm.setState(Eigen::Vector4d(2.5, 0.7, 0.5, -1.0));
    const double at_start = reference.energy(arm.state());
    double furthest = 0.0;  // of the elbow from where it was [rad]
    for (int t = 0; t < 300; ++t) {
      arm.step(Eigen::Vector2d::Zero());
      furthest = std::max(furthest, std::abs(arm.state()[1] - 0.7));
      ASSERT_NEAR(reference.energy(arm.state()), at_start, 1e-7) << gravity << ", step " << t;
    }
    EXPECT_GT(furthest, 1.0);  // energy did go to and fro
  }
}

TEST(TwoLink, GainsTheWorkOfItsMotorsAndLosesThatOfFrictionInEachJoint) {
  // Of a short step from rates alone: dE = (u_1 - b_1 q_1') q_1' dt + (u_2 - b_2 q_2') q_2' dt.
  TwoLinkOptions options = lopsided();
  options.dt = 1e-3;
  const Reference reference(options);
  for (const Eigen::Vector2d& torque :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(3.0, 0.0), Eigen::Vector2d(0.0, -1.5)}) {
    const Eigen::Vector4d state(0.4, 1.1, 1.5, -2.0);
    const Eigen::Vector4d next = stepOf(options, state, torque);
    const Eigen::Vector4d middle = (state + next) / 2;
    const double work = (torque[0] - 0.4 * middle[2]) * middle[2] * options.dt +
                        (torque[1] - 0.07 * middle[3]) * middle[3] * options.dt;
    EXPECT_NEAR(reference.energy(next) - reference.energy(state), work, 1e-3 * std::abs(work));
  }
}

TEST(TwoLink, ComesToRestHangingUnderGravityAndFriction) {
  TwoLinkOptions options = lopsided();
  options.friction = {2.0, 0.5};
  const Reference reference(options);
  TwoLink arm(options);
  arm.setState(Eigen::Vector4d(2.0, -1.0, 0.0, 0.0));
  double energy = reference.energy(arm.state());
  for (int t = 0; t < 400; ++t) {
    arm.step(Eigen::Vector2d::Zero());
    ASSERT_LE(reference.energy(arm.state()), energy + 1e-10) << "step " << t;
    energy = reference.energy(arm.state());
  }
  EXPECT_LT(arm.state().cwiseAbs().maxCoeff(), 1e-6);
}

TEST(TwoLink, IsAPendulumWhereTheLowerLinkWeighsNothing) {
  TwoLinkOptions options = lopsided();
  options.mass[1] = 1e-10;
  options.friction[1] = 0.0;
  PendulumOptions rod;
  rod.gravity = options.gravity;
  rod.length = options.length[0];
  rod.mass = options.mass[0];
  rod.friction = options.friction[0];
  rod.dt = options.dt;
  Pendulum pendulum(rod);
  pendulum.setState(Eigen::Vector2d(1.0, -2.0));
  pendulum.step(Eigen::VectorXd::Constant(1, 1.5));
  const Eigen::Vector4d next = stepOf(options, {1.0, 0.3, -2.0, 0.0}, {1.5, 0.0});
  EXPECT_NEAR(next[0], pendulum.state()[0], 1e-7);
  EXPECT_NEAR(next[2], pendulum.state()[1], 1e-7);
}

TEST(TwoLink, IsOnePendulumOfBothLengthsWhereTheElbowIsStiff) {
  TwoLinkOptions options;  // two equal rods in a line are one uniform rod
  options.gravity = 9.82;
  options.friction = {0.5, 1e5};
  PendulumOptions rod;
  rod.gravity = 9.82;
  rod.length = 1.0;
  rod.mass = 2.0;
  rod.friction = 0.5;
  Pendulum pendulum(rod);
  pendulum.setState(Eigen::Vector2d(1.0, -2.0));
  pendulum.step(Eigen::VectorXd::Constant(1, 3.0));
  const Eigen::Vector4d next = stepOf(options, {1.0, 0.0, -2.0, 0.0}, {3.0, 0.0});
  EXPECT_NEAR(next[0], pendulum.state()[0], 1e-4);
  EXPECT_NEAR(next[2], pendulum.state()[1], 1e-4);
  EXPECT_NEAR(next[1], 0.0, 1e-4);
}

TEST(TwoLink, PushesTheUpperLinkBackWithTheMotorOfTheElbow) {
  // At rest without gravity and friction, the angular momentum about the shoulder stays zero where
  // the elbow alone pulls. In a straight arm it is upper a' + lower b' + coupling (a' + b').
  TwoLinkOptions options = lopsided();
  options.gravity = 0.0;
  options.friction = {0.0, 0.0};
  options.dt = 1e-3;
  const Eigen::Vector4d next = stepOf(options, Eigen::Vector4d::Zero(), {0.0, 2.0});
  EXPECT_GT(next[3], 0.0);
  EXPECT_LT(next[2], 0.0);
  const double a_rate = next[2], b_rate = next[2] + next[3];
  const double upper = (1.3 / 3 + 0.8) * 0.36, lower = 0.8 * 0.35 * 0.35 / 3;
  const double coupling = 0.8 * 0.6 * 0.35 / 2;
  EXPECT_NEAR(upper * a_rate + lower * b_rate + coupling * (a_rate + b_rate), 0.0,
              1e-4 * lower * b_rate);
}

TEST(TwoLink, NeverWrapsAnAngle) {
  TwoLink arm{TwoLinkOptions()};
  for (int t = 0; t < 100; ++t) arm.step(Eigen::Vector2d(4.0, 0.0));
  EXPECT_GT(arm.state()[0], 6 * kPi);
}

TEST(TwoLink, HasItsGoalStraightUpAndTheLargerAngleForItsError) {
  const TwoLink arm{TwoLinkOptions()};
  const auto error = [&](double shoulder, double elbow) {
    return arm.goalError(Eigen::Vector4d(shoulder, elbow, 5.0, -5.0));
  };
  constexpr double kDegree = kPi / 180;
  EXPECT_EQ(arm.goal(), Eigen::Vector4d(kPi, 0.0, 0.0, 0.0));
  EXPECT_EQ(arm.goalError(arm.goal()), 0.0);
  EXPECT_NEAR(error(kPi + 3 * kDegree, -7 * kDegree), 7.0, 1e-12);
  EXPECT_NEAR(error(kPi - 8 * kDegree, 7 * kDegree), 8.0, 1e-12);
  EXPECT_NEAR(error(0.0, 0.0), 180.0, 1e-12);
  EXPECT_NEAR(error(-kPi, 4 * kPi + 2 * kDegree), 2.0, 1e-12);  // the short way round, both
  EXPECT_NEAR(error(kPi, kPi), 180.0, 1e-12);
  EXPECT_EQ(arm.info().error_unit, "deg");
  EXPECT_EQ(arm.info().tolerance, 10.0);
}

TEST(TwoLink, NamesItsJointsStatesAndTorquesWithTheirUnits) {
  const PlantInfo info = TwoLink{TwoLinkOptions()}.info();
  ASSERT_EQ(info.joints.size(), 2U);
  EXPECT_EQ(info.joints[0].name, "shoulder");
  EXPECT_EQ(info.joints[1].name, "elbow");
  EXPECT_EQ(info.joints[0].kind, JointKind::kAngle);
  EXPECT_EQ(info.joints[1].kind, JointKind::kAngle);
  EXPECT_EQ(info.state_names, (std::vector<std::string>{"shoulder_rad", "elbow_rad",
                                                        "shoulder_rad_per_s", "elbow_rad_per_s"}));
  EXPECT_EQ(info.torque_names, (std::vector<std::string>{"shoulder_nm", "elbow_nm"}));
}

TEST(TwoLink, TakesALimitForEachMotorAndASpreadForEachComponent) {
  TwoLinkOptions options;
  options.max_torque = {3.0, 0.5};
  options.start_std = {0.1, 0.2, 0.0, 0.4};
  const TwoLink arm(options);
  EXPECT_EQ(arm.info().max_torque, Eigen::Vector2d(3.0, 0.5));
  EXPECT_EQ(arm.info().start_std, Eigen::Vector4d(0.1, 0.2, 0.0, 0.4));
  options.max_torque = {3.0};
  options.start_std = {0.2};
  const TwoLink even(options);
  EXPECT_EQ(even.info().max_torque, Eigen::Vector2d(3.0, 3.0));
  EXPECT_EQ(even.info().start_std, Eigen::Vector4d::Constant(0.2));
}

TEST(TwoLink, LocatesElbowAndTip) {
  TwoLinkOptions options;
  options.length = {0.5, 0.25};
  const TwoLink arm(options);
  const auto places = [&](double shoulder, double elbow) {
    return arm.visiblePosition(Eigen::Vector4d(shoulder, elbow, 7.0, 7.0));
  };
  EXPECT_LT((places(0.0, 0.0) - Eigen::Vector4d(0.0, -0.5, 0.0, -0.75)).norm(), 1e-15);
  EXPECT_LT((places(kPi, 0.0) - Eigen::Vector4d(0.0, 0.5, 0.0, 0.75)).norm(), 1e-15);
  // Upper link to the right, lower link a quarter turn further: up.
  EXPECT_LT((places(kPi / 2, kPi / 2) - Eigen::Vector4d(0.5, 0.0, 0.5, 0.25)).norm(), 1e-15);
}

int greyAt(const Picture& picture, double x, double y) {  // [m] from the middle
  const double pixel = 2.4 / picture.width;
  const auto column = static_cast<int>(std::floor(picture.width / 2.0 + x / pixel));
  const auto row = static_cast<int>(std::floor(picture.height / 2.0 - y / pixel));
  return picture.bytes[static_cast<std::size_t>(row * picture.width + column)];
}

TEST(TwoLink, LooksLikeOneRodWhereItIsStraight) {
  const TwoLink arm{TwoLinkOptions()};
  const Pendulum rod{PendulumOptions()};  // as long as both links
  for (const double angle : {0.0, kPi, 0.3}) {
    const Picture of_arm = arm.render(Eigen::Vector4d(angle, 0.0, 1.0, 1.0));
    const Picture of_rod = rod.render(Eigen::Vector2d(angle, 0.0));
    ASSERT_EQ(of_arm.bytes.size(), of_rod.bytes.size());
    for (std::size_t i = 0; i < of_arm.bytes.size(); ++i) {
      ASSERT_NEAR(of_arm.bytes[i], of_rod.bytes[i], 1) << angle << ", pixel " << i;
    }
  }
}

TEST(TwoLink, ShowsBothLinksWhereItIsBent) {
  const TwoLink arm{TwoLinkOptions()};
  const Picture picture = arm.render(Eigen::Vector4d(kPi / 2, kPi / 2, 0.0, 0.0));
  EXPECT_GT(greyAt(picture, 0.25, 0.0), 180);
  EXPECT_GT(greyAt(picture, 0.5, 0.25), 180);
  EXPECT_GT(greyAt(picture, 0.5, 0.48), 180);
  EXPECT_EQ(greyAt(picture, 0.25, 0.25), 0);  // between them
  EXPECT_EQ(greyAt(picture, 0.5, 0.75), 0);   // beyond the tip
  EXPECT_EQ(greyAt(picture, 0.75, 0.0), 0);   // beyond the elbow
  EXPECT_EQ(greyAt(picture, -0.25, 0.0), 0);  // behind the shoulder
  EXPECT_EQ(greyAt(picture, 0.5, -0.25), 0);  // bent the other way
}

TEST(TwoLink, RefusesOptionsWithAllTheirProblemsAtOnce) {
  TwoLinkOptions options;
  options.length = {0.5};
  options.mass = {1.0, 0.0};
  options.friction = {0.1, -0.1};
  options.gravity = -1.0;
  options.look.half_extent = 0.0;
  options.dt = 0.0;
  try {
    TwoLink arm(options);
    FAIL() << "an arm with one link was made";
  } catch (const std::invalid_argument& e) {
    const std::string message = e.what();
    for (const char* key : {"plant/length", "plant/mass", "plant/friction", "plant/gravity",
                            "plant/half_extent", "plant/dt"}) {
      EXPECT_NE(message.find(key), std::string::npos) << key << " is not in: " << message;
    }
  }
}

TEST(TwoLink, RefusesListsOfAnotherLengthByName) {
  TwoLinkOptions options;
  options.max_torque = {1.0, 2.0, 3.0};
  EXPECT_THROW(TwoLink{options}, std::invalid_argument);
  options = TwoLinkOptions();
  options.start_std = {0.1, 0.1};
  try {
    TwoLink arm(options);
    FAIL() << "two spreads were taken for four";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("plant/start_std"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace ddm
