// Cost J(U) of a plan by a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ddm_plan_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace ddm {

DdmPlanCost::DdmPlanCost(const Ddm& model, int horizon, double control_weight,
                         std::optional<TimeToGoal> time_to_goal)
    : f_(model.predictionModel()),
      theta_p_(model.thetaP()),
      time_to_goal_(std::move(time_to_goal)),
      roll_out_(f_) {
  setHorizon(horizon);
  setControlWeight(control_weight);
}

void DdmPlanCost::setHorizon(int horizon) {
  if (horizon < 1) throw std::invalid_argument("plan cost: horizon must be >= 1");
  horizon_ = horizon;
  roll_out_.reserve(/*num_targets=*/1, horizon);
  torques_.setZero(f_.torqueDim(), f_.memory() - 1 + horizon);
}

void DdmPlanCost::setControlWeight(double control_weight) {
  control_weight_.setConstant(f_.torqueDim(), control_weight);
  if (!time_to_goal_) return;
  control_weight_ /=
      2.0 * TimeToGoal::kWidth * TimeToGoal::kWidth * f_.maxTorque().array().square();
}

void DdmPlanCost::setGoal(const Eigen::VectorXd& goal_feature) {
  if (goal_feature.size() != f_.featureDim()) {
    throw std::invalid_argument("plan cost: the goal feature does not fit the model");
  }
  if (goal_feature_.size() > 0 && goal_feature_ == goal_feature) return;
  goal_feature_ = goal_feature;
  prepared_ = false;
}

void DdmPlanCost::setExploring(bool exploring) {
  if (exploring == exploring_) return;
  exploring_ = exploring;
  prepared_ = false;
}

void DdmPlanCost::prepare() {
  if (time_to_goal_ && !prepared_) time_to_goal_->setGoal(goal_feature_, exploring_);
  prepared_ = true;
}

void DdmPlanCost::setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                             const Eigen::VectorXd& offset) {
  if (x.empty() || x.features().rows() != f_.featureDim() || x.features().cols() != f_.memory() ||
      x.torques().rows() != f_.torqueDim() || goal_feature.size() != f_.featureDim() ||
      offset.size() != f_.featureDim()) {
    throw std::invalid_argument("plan cost: history, goal feature or offset do not fit the model");
  }
  features_ = x.features().rowwise().reverse();
  torques_.leftCols(f_.memory() - 1) = x.torques().rowwise().reverse();
  setGoal(goal_feature);
  prepare();
  offset_ = offset;
}

void DdmPlanCost::rollOut(const Eigen::Ref<const Eigen::MatrixXd>& U, int num_steps) {
  const Eigen::Index target = f_.memory();  // z_1 follows the features that were seen
  torques_.rightCols(horizon_) = U;
  roll_out_.forward(theta_p_, features_, torques_, RollOut<double>::Targets(&target, 1), num_steps,
                    &offset_);
}

/// z_0, or a predicted feature.
Eigen::VectorXd DdmPlanCost::featureAfter(int num_steps) const {
  if (num_steps == 0) return features_.rightCols(1);
  return roll_out_.predicted(num_steps - 1);
}

/// @param step  0 is the first
/// @param d_z   out: by the feature it leads to; null: not wanted                [feature_dim]
/// @param d_u   out: by its torque; null: not wanted [1/(N m)]                   [torque_dim]
double DdmPlanCost::stepCost(int step, const Eigen::Ref<const Eigen::VectorXd>& u,
                             Eigen::VectorXd* d_z, Eigen::VectorXd* d_u) const {
  const auto z = roll_out_.predicted(step);
  const double effort = (control_weight_ * u.array().square()).sum();
  if (d_u != nullptr) *d_u = 2.0 * control_weight_ * u.array();
  if (!time_to_goal_) {  // eq. (9)
    if (d_z != nullptr) *d_z = 2.0 * (z - goal_feature_);
    return (z - goal_feature_).squaredNorm() + effort;
  }
  const double near = 1.0 - time_to_goal_->away(z, d_z);
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
  if (time_to_goal_) {
    cost += time_to_goal_->value(featureAfter(horizon_), featureAfter(horizon_ - 1),
                                 d_U == nullptr ? nullptr : &d_last, &d_before);
  }
  if (d_U == nullptr) return cost;

  d_torques_.setZero(torques_.rows(), torques_.cols());
  for (int step = 0; step < horizon_; ++step) roll_out_.dPredicted(step).setZero();
  if (time_to_goal_) {
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
  if (!time_to_goal_) return std::nullopt;
  Eigen::MatrixXd U = Eigen::MatrixXd::Zero(f_.torqueDim(), horizon_);
  for (int begin = 0; begin < horizon_; begin += TimeToGoal::kHoldSteps) {
    const int end = std::min(begin + TimeToGoal::kHoldSteps, horizon_);
    double least = std::numeric_limits<double>::infinity();
    Eigen::MatrixXd best = U;
    for (Eigen::Index i = 0; i < time_to_goal_->torques().cols(); ++i) {
      U.middleCols(begin, end - begin).colwise() = time_to_goal_->torques().col(i);
      rollOut(U, end);
      double cost =
          time_to_goal_->value(featureAfter(end), featureAfter(end - 1), nullptr, nullptr);
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

}  // namespace ddm
