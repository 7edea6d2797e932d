// The paper's pendulum: a uniform rod on a motor, with or without gravity.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"
#include "ddm_sim/rod_renderer.h"

namespace ddm {

/// YAML block `plant:` of the type `pendulum`.
struct PendulumOptions : PlantOptions {
  double gravity = 0.0;   ///< g [m/s^2]. 0 fits the trajectories that the authors published
  double length = 1.0;    ///< l, length of the rod [m]
  double mass = 1.0;      ///< m, mass of the rod [kg]
  double friction = 1.0;  ///< b, viscous friction [N m s/rad]
  RodLook look;

  PendulumOptions() { type = "pendulum"; }

  template <class Visitor>
  void visit(Visitor& visitor) {
    PlantOptions::visit(visitor);
    visitor("gravity", gravity);
    visitor("length", length);
    visitor("mass", mass);
    visitor("friction", friction);
    look.visit(visitor);
  }

  std::vector<std::string> problems() const;
};

/// Pendulum with the state (angle [rad], rate [rad/s]) = (phi, omega) and one motor.
///
///   I omega' = u - b omega - m g l sin(phi) / 2,   phi' = omega,   I = m l^2 / 3
///
/// At phi = 0 the rod hangs down; phi = pi is upright and is the goal. The angle is never wrapped.
/// Without gravity the step has a closed form:
///
///   phi+   = phi + dt p1 omega + dt^2 p2 u / I
///   omega+ = e^{-a dt} omega + dt p1 u / I
///   a = b / I,   p1 = (1 - e^{-a dt}) / (a dt),   p2 = (1 - p1) / (a dt)
///
/// At the default values this is
///
///   phi+   = phi + (omega - u)(1 - e^-0.6) / 3 + 0.2 u
///   omega+ = e^-0.6 omega + (1 - e^-0.6) u
///
/// With gravity, an adaptive Dormand-Prince method of order 5 integrates the equation. The error is
/// the angle to the goal along the shorter arc, in [0, 180] deg.
/// Deviation: the paper states neither gravity nor a bound on the torque. Gravity 0 and a bound of
/// 6 N m fit the trajectories that the authors published.
class Pendulum : public Plant {
 public:
  /// @throws std::invalid_argument with all problems of the options
  explicit Pendulum(const PendulumOptions& options);

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override;
  RenderedImage draw(const Eigen::VectorXd& state) const override;

  /// Position of the tip of the rod, l (sin phi, -cos phi): x to the right, y upwards from the
  /// pivot [m].
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override;

  Eigen::Vector2d advanceExactly(const Eigen::Vector2d& state, double torque) const;
  Eigen::Vector2d advanceNumerically(const Eigen::Vector2d& state, double torque) const;

  double length_;          ///< l [m]
  double inertia_;         ///< I [kg m^2]
  double friction_;        ///< b [N m s/rad]
  double gravity_torque_;  ///< m g l / 2 [N m]
  RodRenderer renderer_;
};

}  // namespace ddm
