// Cost J(U) of a plan by a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ddm_plan_cost.h"

#include <stdexcept>

namespace ddm {

DdmPlanCost::DdmPlanCost(const Ddm& model, int horizon, double control_weight)
    : f_(model.predictionModel()),
      theta_p_(model.thetaP()),
      control_weight_(control_weight),
      roll_out_(f_) {
  setHorizon(horizon);
}

void DdmPlanCost::setHorizon(int horizon) {
  if (horizon < 1) throw std::invalid_argument("plan cost: horizon must be >= 1");
  horizon_ = horizon;
  roll_out_.reserve(/*num_targets=*/1, horizon);
  torques_.setZero(f_.torqueDim(), f_.order() - 1 + horizon);
}

void DdmPlanCost::setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                             const Eigen::VectorXd& offset) {
  if (x.empty() || x.features().rows() != f_.featureDim() || x.features().cols() != f_.order() ||
      x.torques().rows() != f_.torqueDim() || goal_feature.size() != f_.featureDim() ||
      offset.size() != f_.featureDim()) {
    throw std::invalid_argument("plan cost: history, goal feature or offset do not fit the model");
  }
  features_ = x.features().rowwise().reverse();
  torques_.leftCols(f_.order() - 1) = x.torques().rowwise().reverse();
  goal_feature_ = goal_feature;
  offset_ = offset;
}

double DdmPlanCost::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) {
  eigen_assert(U.rows() == f_.torqueDim() && U.cols() == horizon_);
  const Eigen::Index target = f_.order();  // z_1 follows the n features that were seen
  const RollOut<double>::Targets targets(&target, 1);
  torques_.rightCols(horizon_) = U;
  roll_out_.forward(theta_p_, features_, torques_, targets, horizon_, &offset_);
  double cost = control_weight_ * U.squaredNorm();
  for (int step = 0; step < horizon_; ++step) {
    cost += (roll_out_.predicted(step) - goal_feature_).squaredNorm();  // eq. (9)
  }
  if (d_U == nullptr) return cost;

  d_torques_.setZero(torques_.rows(), torques_.cols());
  d_torques_.rightCols(horizon_) = 2.0 * control_weight_ * U;
  for (int step = 0; step < horizon_; ++step) roll_out_.dPredicted(step).setZero();
  for (int step = horizon_ - 1; step >= 0; --step) {
    roll_out_.dPredicted(step) += 2.0 * (roll_out_.predicted(step) - goal_feature_);
    roll_out_.backward(theta_p_, targets, step, nullptr, nullptr, &d_torques_);
  }
  *d_U = d_torques_.rightCols(horizon_);
  return cost;
}

Eigen::MatrixXd DdmPlanCost::predictedFeatures() const {
  Eigen::MatrixXd out(f_.featureDim(), horizon_ + 1);
  out.col(0) = features_.rightCols(1);
  for (int step = 0; step < horizon_; ++step) out.col(step + 1) = roll_out_.predicted(step);
  return out;
}

}  // namespace ddm
