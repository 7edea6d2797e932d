// An arm of two links with a motor in each joint.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"
#include "ddm_sim/rod_renderer.h"

namespace ddm {

/// YAML block `plant:` of the type `two_link`. Lists: shoulder, elbow.
struct TwoLinkOptions : PlantOptions {
  double gravity = 0.0;                     ///< g [m/s^2]
  std::vector<double> length = {0.5, 0.5};  ///< l_1, l_2, lengths of the links [m]
  std::vector<double> mass = {1.0, 1.0};    ///< m_1, m_2, masses of the links [kg]
  /// b_1, b_2, viscous friction of the joints [N m s/rad]
  std::vector<double> friction = {0.5, 0.15};
  RodLook look;

  TwoLinkOptions() {
    type = "two_link";
    max_torque = {4.0, 2.0};
  }

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

/// Two uniform rods with the state (q_1, q_2 [rad], q_1', q_2' [rad/s]). q_1 is the angle of the
/// upper link, which hangs down at 0. q_2 is the angle of the lower link relative to the upper
/// link. The angles are never wrapped.
///
///   [A + B + 2 c cos q_2,  B + c cos q_2] q'' = [u_1 - b_1 q_1' + h (2 q_1' q_2' + q_2'^2) - G_1]
///   [B + c cos q_2,        B            ]       [u_2 - b_2 q_2' - h q_1'^2 - G_2               ]
///
///   A = m_1 l_1^2 / 3 + m_2 l_1^2,   B = m_2 l_2^2 / 3,   c = m_2 l_1 l_2 / 2,   h = c sin q_2
///   G_2 = g m_2 l_2 sin(q_1 + q_2) / 2,   G_1 = g (m_1 / 2 + m_2) l_1 sin q_1 + G_2
///
/// An adaptive Dormand-Prince method of order 5 integrates the equation. The goal is (pi, 0), both
/// links upright. The error is the larger of the two angles to the goal along the shorter arc
/// [deg].
class TwoLink : public Plant {
 public:
  /// @throws std::invalid_argument with all problems of the options
  explicit TwoLink(const TwoLinkOptions& options);

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override;
  RenderedImage draw(const Eigen::VectorXd& state) const override;

  /// Positions (x, y) of elbow and tip: x to the right and y upwards from the shoulder [m]. [4 x 1]
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override;

  std::vector<Rod> links(const Eigen::VectorXd& state) const;

  Eigen::Vector2d length_, mass_, friction_;
  double gravity_;
  RodRenderer renderer_;
};

}  // namespace ddm
