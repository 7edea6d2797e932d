// pilco_check: one step of the pendulum.
// SPDX-License-Identifier: BSD-3-Clause
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <vector>

#include "check/kinds.h"
#include "check/scenario.h"

namespace ddm {
namespace pilco {
namespace check {

void checkSimulation(Case* reference) {
  const Scenario scenario = readScenario(reference);
  reference->compareNumber("dt", scenario.time_step, absolute(1e-12));
  const Eigen::VectorXd start = reference->vector("x0", 2);
  const double torque = reference->number("u");
  // State [rate, angle]; mass and length are 1, and so the moment of inertia is 1/3.
  using State = std::vector<double>;
  const auto ode = [&scenario, torque](const State& x, State& dx, double) {
    dx[0] = 3.0 * (torque - scenario.friction * x[0] - 0.5 * scenario.gravity * std::sin(x[1]));
    dx[1] = x[0];
  };
  namespace odeint = boost::numeric::odeint;
  State x = {start[0], start[1]};
  odeint::integrate_adaptive(
      odeint::make_controlled(1e-13, 1e-13, odeint::runge_kutta_dopri5<State>()), ode, x, 0.0,
      scenario.time_step, 0.01 * scenario.time_step);
  reference->compareVector("x1", Eigen::Vector2d(x[0], x[1]), absolute(1e-9));
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
