// Cost J(U) of a plan by a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ddm_plan_cost.h"

#include <stdexcept>

namespace ddm {

DdmPlanCost::DdmPlanCost(const Ddm& model, int horizon, double control_weight,
                         const DistanceCost& distance_cost)
    : f_(model.predictionModel()),
      theta_p_(model.thetaP()),
      control_weight_(control_weight),
      distance_cost_(distance_cost),
      max_torque_(model.options().max_torque),
      order_(f_.order()),
      past_torques_(Eigen::MatrixXd::Zero(f_.torqueDim(), order_ - 1)),
      regressor_(f_.regressorDim()) {
  setHorizon(horizon);
}

void DdmPlanCost::setHorizon(int horizon) {
  if (horizon < 1) throw std::invalid_argument("plan cost: horizon must be >= 1");
  horizon_ = horizon;
  features_.setZero(f_.featureDim(), order_ + horizon);
  d_features_ = features_;
  slopes_.resize(horizon);
  tapes_.resize(horizon);
}

void DdmPlanCost::setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                             const Eigen::VectorXd& offset) {
  if (x.empty() || x.features().rows() != f_.featureDim() || x.features().cols() != order_ ||
      x.torques().rows() != f_.torqueDim() || goal_feature.size() != f_.featureDim() ||
      offset.size() != f_.featureDim()) {
    throw std::invalid_argument("plan cost: history, goal feature or offset do not fit the model");
  }
  features_.leftCols(order_) = x.features().rowwise().reverse();
  past_torques_ = x.torques() / max_torque_;
  goal_feature_ = goal_feature;
  offset_ = offset;
}

/// h of the step from z_step to z_{step+1}.
void DdmPlanCost::fillRegressor(int step, const Eigen::Ref<const Eigen::MatrixXd>& U) {
  for (int lag = 0; lag < order_; ++lag) {
    regressor_.segment(f_.featureRow(lag), f_.featureDim()) =
        features_.col(order_ - 1 + step - lag);
    auto torque = regressor_.segment(f_.torqueRow(lag), f_.torqueDim());
    if (step >= lag) {
      torque = U.col(step - lag) / max_torque_;
    } else {
      torque = past_torques_.col(lag - step - 1);
    }
  }
}

/// Cost of z_{step+1}; notes its slope.
double DdmPlanCost::distanceCost(int step) {
  const double weight = step + 1 == horizon_ ? distance_cost_.terminal_weight : 1.0;
  const double squared = (features_.col(order_ + step) - goal_feature_).squaredNorm();
  const double cost = weight * distance_cost_.of(squared, &slopes_[step]);
  slopes_[step] *= weight;
  return cost;
}

double DdmPlanCost::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) {
  eigen_assert(U.rows() == f_.torqueDim() && U.cols() == horizon_);
  double cost = control_weight_ * U.squaredNorm();
  for (int step = 0; step < horizon_; ++step) {
    fillRegressor(step, U);
    f_.forward(theta_p_, regressor_, &tapes_[step], features_.col(order_ + step));
    features_.col(order_ + step) += offset_;
    cost += distanceCost(step);
  }
  if (d_U == nullptr) return cost;

  *d_U = 2.0 * control_weight_ * U;
  d_features_.setZero();
  for (int step = horizon_ - 1; step >= 0; --step) {
    d_features_.col(order_ + step) +=
        2.0 * slopes_[step] * (features_.col(order_ + step) - goal_feature_);
    f_.backward(theta_p_, &tapes_[step], d_features_.col(order_ + step), nullptr, &d_regressor_);
    for (int lag = 0; lag < order_; ++lag) {
      d_features_.col(order_ - 1 + step - lag) +=
          d_regressor_.col(0).segment(f_.featureRow(lag), f_.featureDim());
      if (step >= lag) {
        d_U->col(step - lag) +=
            d_regressor_.col(0).segment(f_.torqueRow(lag), f_.torqueDim()) / max_torque_;
      }
    }
  }
  return cost;
}

Eigen::MatrixXd DdmPlanCost::predictedFeatures() const { return features_.rightCols(horizon_ + 1); }

}  // namespace ddm
