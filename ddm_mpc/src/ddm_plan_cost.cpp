// Cost J(U) of a plan for a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ddm_plan_cost.h"

#include <ddm_model/per_motor.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace ddm {

DdmPlanCost::DdmPlanCost(const Ddm& model, int horizon, double control_weight,
                         std::optional<CostToGo> cost_to_go)
    : f_(model.predictionModel()),
      theta_p_(model.thetaP()),
      horizon_(horizon),
      control_weight_(Eigen::ArrayXd::Constant(f_.torqueDim(), control_weight)),
      cost_to_go_(std::move(cost_to_go)),
      roll_out_(f_) {
  eigen_assert(horizon >= 1);
  roll_out_.reserve(/*num_targets=*/1, horizon);
  torques_.setZero(f_.torqueDim(), f_.memory() - 1 + horizon);
  if (!cost_to_go_) return;
  control_weight_ /= 2.0 * CostToGo::kWidth * CostToGo::kWidth * f_.maxTorque().array().square();
}

void DdmPlanCost::setGoal(const Eigen::VectorXd& goal_feature, bool exploring) {
  eigen_assert(goal_feature.size() == f_.featureDim());
  const bool same_goal = goal_feature_.size() > 0 && goal_feature_ == goal_feature;
  if (same_goal && exploring_ == exploring) return;
  goal_feature_ = goal_feature;
  exploring_ = exploring;
  if (cost_to_go_) cost_to_go_->setGoal(goal_feature, exploring);
}

void DdmPlanCost::setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                             const Eigen::VectorXd& offset) {
  eigen_assert(!x.empty() && x.features().rows() == f_.featureDim() &&
               x.features().cols() == f_.memory() && x.torques().rows() == f_.torqueDim() &&
               offset.size() == f_.featureDim());
  features_ = x.features().rowwise().reverse();
  torques_.leftCols(f_.memory() - 1) = x.torques().rowwise().reverse();
  setGoal(goal_feature, exploring_);
  offset_ = offset;
}

void DdmPlanCost::rollOut(const Eigen::Ref<const Eigen::MatrixXd>& U, int num_steps) {
  const Eigen::Index target = f_.memory();  // index of z_1 after the features of x_0
  torques_.rightCols(horizon_) = U;
  roll_out_.forward(theta_p_, features_, torques_, RollOut<double>::Targets(&target, 1), num_steps,
                    &offset_);
}

/// @return z_{num_steps}; z_0 is the current feature  [feature_dim]
Eigen::VectorXd DdmPlanCost::featureAfter(int num_steps) const {
  if (num_steps == 0) return features_.rightCols(1);
  return roll_out_.predicted(num_steps - 1);
}

/// @param step  index of the step, from 0 on; leads to z_{step + 1}
/// @param u     torque of the step [N m]                                         [torque_dim]
/// @param d_z   out: derivative by z_{step + 1}; null: skip                     [feature_dim]
/// @param d_u   out: derivative by u [1/(N m)]; null: skip                       [torque_dim]
double DdmPlanCost::stepCost(int step, const Eigen::Ref<const Eigen::VectorXd>& u,
                             Eigen::VectorXd* d_z, Eigen::VectorXd* d_u) const {
  const auto z = roll_out_.predicted(step);
  const double effort = (control_weight_ * u.array().square()).sum();
  if (d_u != nullptr) *d_u = 2.0 * control_weight_ * u.array();
  if (!cost_to_go_) {  // eq. (9)
    if (d_z != nullptr) *d_z = 2.0 * (z - goal_feature_);
    return (z - goal_feature_).squaredNorm() + effort;
  }
  const double near = 1.0 - cost_to_go_->stepCost(z, d_z);
  const double gentle = std::exp(-effort);
  if (d_z != nullptr) *d_z *= gentle;
  if (d_u != nullptr) *d_u *= near * gentle;
  return 1.0 - near * gentle;
}

double DdmPlanCost::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) {
  eigen_assert(U.rows() == f_.torqueDim() && U.cols() == horizon_);
  rollOut(U, horizon_);
  double cost = 0.0;
  for (int step = 0; step < horizon_; ++step) {
    cost += stepCost(step, U.col(step), nullptr, nullptr);
  }
  Eigen::VectorXd d_last, d_before;
  if (cost_to_go_) {
    cost += cost_to_go_->value(featureAfter(horizon_), featureAfter(horizon_ - 1),
                               d_U == nullptr ? nullptr : &d_last, &d_before);
  }
  if (d_U == nullptr) return cost;

  d_torques_.setZero(torques_.rows(), torques_.cols());
  for (int step = 0; step < horizon_; ++step) roll_out_.dPredicted(step).setZero();
  if (cost_to_go_) {
    roll_out_.dPredicted(horizon_ - 1) += d_last;
    if (horizon_ > 1) roll_out_.dPredicted(horizon_ - 2) += d_before;
  }
  const Eigen::Index target = f_.memory();
  const RollOut<double>::Targets targets(&target, 1);
  for (int step = horizon_ - 1; step >= 0; --step) {
    stepCost(step, U.col(step), &d_step_, &d_torque_);
    roll_out_.dPredicted(step) += d_step_;
    d_torques_.col(f_.memory() - 1 + step) += d_torque_;
    roll_out_.backward(theta_p_, targets, step, nullptr, nullptr, &d_torques_);
  }
  *d_U = d_torques_.rightCols(horizon_);
  return cost;
}

std::optional<Eigen::MatrixXd> DdmPlanCost::proposal() {
  if (!cost_to_go_) return std::nullopt;
  Eigen::MatrixXd U = Eigen::MatrixXd::Zero(f_.torqueDim(), horizon_);
  for (int begin = 0; begin < horizon_; begin += CostToGo::kHoldSteps) {
    const int end = std::min(begin + CostToGo::kHoldSteps, horizon_);
    double least = std::numeric_limits<double>::infinity();
    Eigen::MatrixXd best = U;
    for (Eigen::Index i = 0; i < cost_to_go_->torques().cols(); ++i) {
      U.middleCols(begin, end - begin).colwise() = cost_to_go_->torques().col(i);
      rollOut(U, end);
      double cost = cost_to_go_->value(featureAfter(end), featureAfter(end - 1), nullptr, nullptr);
      for (int step = begin; step < end; ++step) {
        cost += stepCost(step, U.col(step), nullptr, nullptr);
      }
      if (cost < least) {
        least = cost;
        best = U;
      }
    }
    U = best;
  }
  return U;
}

Eigen::MatrixXd DdmPlanCost::predictedFeatures() const {
  Eigen::MatrixXd out(f_.featureDim(), horizon_ + 1);
  out.col(0) = features_.rightCols(1);
  for (int step = 0; step < horizon_; ++step) out.col(step + 1) = roll_out_.predicted(step);
  return out;
}

DdmPlanCost makePlanCost(const Ddm& model, const MpcOptions& options) {
  if (!within(options.max_torque, model.options().max_torque)) {
    throw std::invalid_argument("mpc/max_torque must be at most the model's model/max_torque " +
                                limitsText(model.options().max_torque) + " N m, got " +
                                limitsText(options.max_torque) +
                                ": lower it, or train a model for larger torques from the bags");
  }
  if (options.cost == "distance") {
    return DdmPlanCost(model, options.horizon, options.control_weight);
  }
  if (model.torqueDim() > CostToGo::kMaxMotors) {
    throw std::invalid_argument("mpc/cost time needs a model with at most " +
                                std::to_string(CostToGo::kMaxMotors) +
                                " motors, as it compares 3^motors sets of torques, got " +
                                std::to_string(model.torqueDim()) + ": set mpc/cost to distance");
  }
  if (model.info().support_states.cols() < 2) {
    throw std::invalid_argument(
        "mpc/cost time needs a model with support states, and this one has none: train it again "
        "from its bags, or set mpc/cost to distance");
  }
  return DdmPlanCost(
      model, options.horizon, options.control_weight,
      CostToGo(model, perMotor(options.max_torque, model.torqueDim(), "mpc/max_torque")));
}

}  // namespace ddm
