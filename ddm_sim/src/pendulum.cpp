// Equations of motion of the pendulum.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/pendulum.h"

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

namespace ddm {
namespace {

// Absolute and relative error per internal step. One step and 100 steps of a hundredth of its
// length must agree within 1e-9; this tolerance leaves a margin of several orders of magnitude.
constexpr double kTolerance = 1e-12;

PlantInfo infoOf(const PendulumOptions& options) {
  PlantInfo info;
  info.joints = {{"pendulum", JointKind::kAngle}};
  info.state_names = {"angle_rad", "rate_rad_per_s"};
  info.torque_names = {"torque_nm"};
  info.max_torque = forEach(options.max_torque, 1, "plant/max_torque");
  info.dt = options.dt;
  info.start = Eigen::VectorXd::Zero(2);
  info.start_std = forEach(options.start_std, 2, "plant/start_std");
  info.goal = (Eigen::VectorXd(2) << kPi, 0.0).finished();
  info.error_unit = "deg";
  info.tolerance = 10.0;
  return info;
}

/// (1 - p1(x)) / x with p1(x) = (1 - e^-x) / x, the weight of u in the angle; 1/2 at x = 0.
double secondWeight(double x) {
  if (x > 1e-2) return (x + std::expm1(-x)) / (x * x);
  // The expression above cancels for small x. Six terms of the Taylor series leave an error below
  // 1e-16.
  return 1.0 / 2 -
         x * (1.0 / 6 - x * (1.0 / 24 - x * (1.0 / 120 - x * (1.0 / 720 - x * (1.0 / 5040)))));
}

}  // namespace

std::vector<std::string> PendulumOptions::problems() const {
  OptionChecks plant("plant");
  plant.requireNotNegative("gravity", gravity);
  plant.requirePositive("length", length);
  plant.requirePositive("mass", mass);
  plant.requireNotNegative("friction", friction);
  plant.add(PlantOptions::problems());
  plant.add(look.problems());
  return plant.problems();
}

Pendulum::Pendulum(const PendulumOptions& options)
    : Plant(infoOf(checked(options))),
      length_(options.length),
      inertia_(options.mass * options.length * options.length / 3.0),
      friction_(options.friction),
      gravity_torque_(options.mass * options.gravity * options.length / 2.0),
      renderer_(options.image_size, options.look) {}

Eigen::VectorXd Pendulum::advance(const Eigen::VectorXd& state,
                                  const Eigen::VectorXd& torque) const {
  return gravity_torque_ == 0.0 ? advanceExactly(state, torque[0])
                                : advanceNumerically(state, torque[0]);
}

Eigen::Vector2d Pendulum::advanceExactly(const Eigen::Vector2d& state, double torque) const {
  const double x = friction_ / inertia_ * info().dt;
  const double p1 = x > 0.0 ? -std::expm1(-x) / x : 1.0;
  const double p2 = secondWeight(x);
  const double acceleration = torque / inertia_;  // of the rod at rest
  return {state[0] + info().dt * p1 * state[1] + info().dt * info().dt * p2 * acceleration,
          std::exp(-x) * state[1] + info().dt * p1 * acceleration};
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
  odeint::integrate_adaptive(stepper, derivative, x, 0.0, info().dt, info().dt / 10.0);
  return {x[0], x[1]};
}

double Pendulum::distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const {
  return degreesBetween(state[0], goal[0]);
}

RenderedImage Pendulum::draw(const Eigen::VectorXd& state) const {
  return renderer_.render({{Eigen::Vector2d::Zero(), state[0], length_}});
}

Eigen::VectorXd Pendulum::locate(const Eigen::VectorXd& state) const {
  return length_ * Eigen::Vector2d(std::sin(state[0]), -std::cos(state[0]));
}

}  // namespace ddm
