// The paper's pendulum: a uniform rod on a motor, with or without gravity.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/pendulum.h"

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

namespace ddm {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Error per internal step, absolute and relative: leaves a margin of several orders to the 1e-9
// within which a step and 100 steps of a hundredth of the length agree.
constexpr double kTolerance = 1e-12;

/// `plant` unchanged, so that the checks precede the first use of its values.
const PlantOptions& checked(const PlantOptions& plant, const CameraOptions& camera) {
  requireNone(problemsOf(plant, camera));
  return plant;
}

/// (1 - p1(x)) / x with p1(x) = (1 - e^-x) / x, the weight of u in the angle; 1/2 at x = 0.
double secondWeight(double x) {
  if (x > 1e-2) return (x + std::expm1(-x)) / (x * x);
  // The difference above cancels for small x; six terms leave an error below 1e-16.
  return 1.0 / 2 -
         x * (1.0 / 6 - x * (1.0 / 24 - x * (1.0 / 120 - x * (1.0 / 720 - x * (1.0 / 5040)))));
}

}  // namespace

Pendulum::Pendulum(const PlantOptions& plant, const CameraOptions& camera)
    : Plant(Eigen::Vector2d::Zero(), 1, checked(plant, camera).dt, plant.max_torque,
            plant.start_std),
      length_(plant.length),
      inertia_(plant.mass * plant.length * plant.length / 3.0),
      friction_(plant.friction),
      gravity_torque_(plant.mass * plant.gravity * plant.length / 2.0),
      renderer_(camera, plant.length) {}

Eigen::VectorXd Pendulum::goalState() const { return Eigen::Vector2d(kPi, 0.0); }

Eigen::VectorXd Pendulum::advance(const Eigen::VectorXd& state,
                                  const Eigen::VectorXd& torque) const {
  return gravity_torque_ == 0.0 ? advanceExactly(state, torque[0])
                                : advanceNumerically(state, torque[0]);
}

Eigen::Vector2d Pendulum::advanceExactly(const Eigen::Vector2d& state, double torque) const {
  const double x = friction_ / inertia_ * dt();
  const double p1 = x > 0.0 ? -std::expm1(-x) / x : 1.0;
  const double p2 = secondWeight(x);
  const double acceleration = torque / inertia_;  // of the rod at rest
  return {state[0] + dt() * p1 * state[1] + dt() * dt() * p2 * acceleration,
          std::exp(-x) * state[1] + dt() * p1 * acceleration};
}

Eigen::Vector2d Pendulum::advanceNumerically(const Eigen::Vector2d& state, double torque) const {
  namespace odeint = boost::numeric::odeint;
  using State = std::array<double, 2>;
  const auto derivative = [this, torque](const State& x, State& dxdt, double /*t*/) {
    dxdt[0] = x[1];
    dxdt[1] = (torque - friction_ * x[1] - gravity_torque_ * std::sin(x[0])) / inertia_;
  };
  State x{state[0], state[1]};
  const auto stepper =
      odeint::make_controlled(kTolerance, kTolerance, odeint::runge_kutta_dopri5<State>());
  odeint::integrate_adaptive(stepper, derivative, x, 0.0, dt(), dt() / 10.0);
  return {x[0], x[1]};
}

double Pendulum::distanceToGoal(const Eigen::VectorXd& state) const {
  return std::abs(std::remainder(state[0] - kPi, 2.0 * kPi));
}

std::vector<std::uint8_t> Pendulum::draw(const Eigen::VectorXd& state) const {
  return renderer_.render(state[0]);
}

Eigen::VectorXd Pendulum::locate(const Eigen::VectorXd& state) const {
  return length_ * Eigen::Vector2d(std::sin(state[0]), -std::cos(state[0]));
}

}  // namespace ddm
