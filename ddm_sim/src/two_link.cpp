// Equations of motion of the arm of two links.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/two_link.h"

#include <ddm_common/option_checks.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

namespace ddm {
namespace {

// Absolute and relative error per internal step, as for the pendulum.
constexpr double kTolerance = 1e-12;

PlantInfo infoOf(const TwoLinkOptions& options) {
  PlantInfo info;
  info.joints = {{"shoulder", JointKind::kAngle}, {"elbow", JointKind::kAngle}};
  info.state_names = {"shoulder_rad", "elbow_rad", "shoulder_rad_per_s", "elbow_rad_per_s"};
  info.torque_names = {"shoulder_nm", "elbow_nm"};
  info.max_torque = forEach(options.max_torque, 2, "plant/max_torque");
  info.dt = options.dt;
  info.start = Eigen::VectorXd::Zero(4);
  info.start_std = forEach(options.start_std, 4, "plant/start_std");
  info.goal = (Eigen::VectorXd(4) << kPi, 0.0, 0.0, 0.0).finished();
  info.error_unit = "deg";
  info.tolerance = 10.0;
  return info;
}

}  // namespace

std::vector<std::string> TwoLinkOptions::problems() const {
  OptionChecks plant("plant");
  const auto pair = [&plant](const std::vector<double>& values, const char* key) {
    plant.require(values.size() == 2, key, "have two numbers, of shoulder and elbow",
                  values.size());
  };
  plant.requireNotNegative("gravity", gravity);
  pair(length, "length");
  for (const double value : length) plant.requirePositive("length", value);
  pair(mass, "mass");
  for (const double value : mass) plant.requirePositive("mass", value);
  pair(friction, "friction");
  for (const double value : friction) plant.requireNotNegative("friction", value);
  plant.add(PlantOptions::problems());
  plant.add(look.problems());
  return plant.problems();
}

TwoLink::TwoLink(const TwoLinkOptions& options)
    : Plant(infoOf(checked(options))),
      length_(options.length[0], options.length[1]),
      mass_(options.mass[0], options.mass[1]),
      friction_(options.friction[0], options.friction[1]),
      gravity_(options.gravity),
      renderer_(options.image_size, options.look) {}

Eigen::VectorXd TwoLink::advance(const Eigen::VectorXd& state,
                                 const Eigen::VectorXd& torque) const {
  namespace odeint = boost::numeric::odeint;
  using State = std::array<double, 4>;
  const double A = (mass_[0] / 3.0 + mass_[1]) * length_[0] * length_[0];
  const double B = mass_[1] * length_[1] * length_[1] / 3.0;
  const double c = mass_[1] * length_[0] * length_[1] / 2.0;
  const double g_upper = gravity_ * (mass_[0] / 2.0 + mass_[1]) * length_[0];
  const double g_lower = gravity_ * mass_[1] * length_[1] / 2.0;
  const auto derivative = [&](const State& x, State& dxdt, double /*t*/) {
    const double h = c * std::sin(x[1]);
    const double off_diagonal = B + c * std::cos(x[1]);
    const double G_2 = g_lower * std::sin(x[0] + x[1]);
    const double G_1 = g_upper * std::sin(x[0]) + G_2;
    Eigen::Matrix2d M;
    M << A + B + 2.0 * c * std::cos(x[1]), off_diagonal, off_diagonal, B;
    const Eigen::Vector2d force(
        torque[0] - friction_[0] * x[2] + h * (2.0 * x[2] * x[3] + x[3] * x[3]) - G_1,
        torque[1] - friction_[1] * x[3] - h * x[2] * x[2] - G_2);
    const Eigen::Vector2d acceleration = M.inverse() * force;
    dxdt = {x[2], x[3], acceleration[0], acceleration[1]};
  };
  State x{state[0], state[1], state[2], state[3]};
  const auto stepper =
      odeint::make_controlled(kTolerance, kTolerance, odeint::runge_kutta_dopri5<State>());
  odeint::integrate_adaptive(stepper, derivative, x, 0.0, info().dt, info().dt / 10.0);
  return Eigen::Vector4d(x[0], x[1], x[2], x[3]);
}

double TwoLink::distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const {
  return std::max(degreesBetween(state[0], goal[0]), degreesBetween(state[1], goal[1]));
}

std::vector<Rod> TwoLink::links(const Eigen::VectorXd& state) const {
  const Rod upper{Eigen::Vector2d::Zero(), state[0], length_[0]};
  return {upper, {upper.end(), state[0] + state[1], length_[1]}};
}

RenderedImage TwoLink::draw(const Eigen::VectorXd& state) const {
  return renderer_.render(links(state));
}

Eigen::VectorXd TwoLink::locate(const Eigen::VectorXd& state) const {
  const std::vector<Rod> rods = links(state);
  Eigen::Vector4d places;
  places << rods[0].end(), rods[1].end();
  return places;
}

}  // namespace ddm
