// Tests of the arm: an independent integrator, energy, known limits, goal and image.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/two_link.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_sim/pendulum.h"

namespace ddm {
namespace {

/// Links that differ in all parameters, so that a mix-up of two terms changes the result.
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

/// Euler-Lagrange equations in the absolute angles (a, b) of both links. The code under test uses
/// relative angles:
///
///   T = (m_1 / 3 + m_2) l_1^2 a'^2 / 2 + m_2 l_2^2 b'^2 / 6 + m_2 l_1 l_2 cos(a - b) a' b' / 2
///   V = -g (m_1 / 2 + m_2) l_1 cos a - g m_2 l_2 cos(b) / 2
///
/// The torque and the friction of the elbow act on the lower link, and with the opposite sign on
/// the upper link.
class Reference {
 public:
  explicit Reference(const TwoLinkOptions& o)
      : o_(o),
        upper_((o.mass[0] / 3 + o.mass[1]) * o.length[0] * o.length[0]),
        lower_(o.mass[1] * o.length[1] * o.length[1] / 3),
        coupling_(o.mass[1] * o.length[0] * o.length[1] / 2),
        weight_a_(o.gravity * (o.mass[0] / 2 + o.mass[1]) * o.length[0]),
        weight_b_(o.gravity * o.mass[1] * o.length[1] / 2) {}

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
  double upper_, lower_, coupling_;  ///< entries of the inertia matrix [kg m^2]
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

TEST(TwoLink, HasItsGoalStraightUpAndTheLargerAngleForItsError) {
  const TwoLink arm{TwoLinkOptions()};
  const auto error = [&](double shoulder, double elbow) {
    return arm.goalError(Eigen::Vector4d(shoulder, elbow, 5.0, -5.0));
  };
  constexpr double kDegree = kPi / 180;
  EXPECT_EQ(arm.goal(), Eigen::Vector4d(kPi, 0.0, 0.0, 0.0));
  EXPECT_NEAR(error(kPi + 3 * kDegree, -7 * kDegree), 7.0, 1e-12);
  EXPECT_NEAR(error(kPi - 8 * kDegree, 7 * kDegree), 8.0, 1e-12);
  EXPECT_NEAR(error(0.0, 0.0), 180.0, 1e-12);
  EXPECT_NEAR(error(-kPi, 4 * kPi + 2 * kDegree), 2.0, 1e-12);  // both along the shorter arc
  EXPECT_NEAR(error(kPi, kPi), 180.0, 1e-12);
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
  // The upper link points to the right, and the lower link is turned by a further quarter: it
  // points up.
  EXPECT_LT((places(kPi / 2, kPi / 2) - Eigen::Vector4d(0.5, 0.0, 0.5, 0.25)).norm(), 1e-15);
}

TEST(TwoLink, LooksLikeOneRodWhereItIsStraight) {
  const TwoLink arm{TwoLinkOptions()};
  const Pendulum rod{PendulumOptions()};  // as long as both links together
  for (const double angle : {0.0, kPi, 0.3}) {
    const RenderedImage of_arm = arm.render(Eigen::Vector4d(angle, 0.0, 1.0, 1.0));
    const RenderedImage of_rod = rod.render(Eigen::Vector2d(angle, 0.0));
    ASSERT_EQ(of_arm.bytes.size(), of_rod.bytes.size());
    for (std::size_t i = 0; i < of_arm.bytes.size(); ++i) {
      ASSERT_NEAR(of_arm.bytes[i], of_rod.bytes[i], 1) << angle << ", pixel " << i;
    }
  }
}

TEST(TwoLink, RefusesListsThatAreNotOfTwoLinks) {
  TwoLinkOptions options;
  options.length = {0.5};
  options.mass = {1.0, 1.0, 1.0};
  options.friction = {};
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&] { TwoLink arm(options); }, {"plant/length", "plant/mass", "plant/friction"}));
}

}  // namespace
}  // namespace ddm
