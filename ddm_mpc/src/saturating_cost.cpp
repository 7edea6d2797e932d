// Saturating cost of a step, for plants whose way to the goal first leads away from it.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/saturating_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ddm {
namespace {

/// @return all combinations of the torques -max, 0 and max  [torque_dim x 3^torque_dim]
Eigen::MatrixXd combinations(const Eigen::VectorXd& max_torque) {
  Eigen::Index count = 1;
  for (Eigen::Index motor = 0; motor < max_torque.size(); ++motor) count *= 3;
  Eigen::MatrixXd torques(max_torque.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    Eigen::Index digits = i;
    for (Eigen::Index motor = 0; motor < max_torque.size(); ++motor, digits /= 3) {
      torques(motor, i) = static_cast<double>(digits % 3 - 1) * max_torque[motor];
    }
  }
  return torques;
}

double spreadOf(const Ddm& model) {
  const Eigen::MatrixXd Z = model.info().support_states.cast<double>().topRows(model.featureDim());
  return std::max((Z.colwise() - Z.rowwise().mean()).norm() / std::sqrt(Z.cols()),
                  std::numeric_limits<double>::min());
}

}  // namespace

SaturatingCost::SaturatingCost(const Ddm& model, const Eigen::VectorXd& max_torque, double width)
    : torques_(combinations(max_torque)), width_(width), spread_(spreadOf(model)) {
  eigen_assert(model.info().support_states.cols() >= 2 && max_torque.size() == model.torqueDim() &&
               max_torque.size() <= kMaxMotors);
}

double SaturatingCost::evaluate(const Eigen::Ref<const Eigen::VectorXd>& z,
                                Eigen::VectorXd* gradient) const {
  const double sigma = width_ * spread_;
  const double near = std::exp(-0.5 * (z - z_ref_).squaredNorm() / (sigma * sigma));
  if (gradient != nullptr) *gradient = (near / (sigma * sigma)) * (z - z_ref_);
  return 1.0 - near;
}

}  // namespace ddm
