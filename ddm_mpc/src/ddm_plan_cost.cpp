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
#include <vector>

namespace ddm {
namespace {

// Weight of a change of torque / lambda. Without it, torques at the goal alternate more and more in
// sign: 172 of 200 models of the pendulum after 100 images reach the goal instead of 185.
constexpr double kChangeWeight = 10.0;

}  // namespace

DdmPlanCost::DdmPlanCost(const Ddm& model, int horizon, double control_weight, Terms terms)
    : f_(model.predictionModel()),
      theta_p_(model.thetaP()),
      horizon_(horizon),
      control_weight_(Eigen::ArrayXd::Constant(f_.torqueDim(), control_weight)),
      terms_(std::move(terms)),
      roll_out_(f_),
      search_(f_) {
  eigen_assert(horizon >= 1);
  roll_out_.reserve(/*num_targets=*/1, horizon);
  torques_.setZero(f_.torqueDim(), f_.order() - 1 + horizon);
  if (const SaturatingCost* saturating = saturatingCost()) {
    const double width = saturating->width();
    control_weight_ /= 2.0 * width * width * f_.maxTorque().array().square();
  }
}

/// @return cost of a step; null: eq. (9)
const SaturatingCost* DdmPlanCost::saturatingCost() const {
  if (const auto* cost_to_go = std::get_if<CostToGo>(&terms_)) return &cost_to_go->stepCost();
  return std::get_if<SaturatingCost>(&terms_);
}

void DdmPlanCost::setGoal(const Eigen::VectorXd& goal_feature, bool exploring) {
  eigen_assert(goal_feature.size() == f_.featureDim());
  const bool same_goal = goal_feature_.size() > 0 && goal_feature_ == goal_feature;
  if (same_goal && exploring_ == exploring) return;
  goal_feature_ = goal_feature;
  exploring_ = exploring;
  if (auto* cost_to_go = std::get_if<CostToGo>(&terms_)) {
    cost_to_go->setGoal(goal_feature, exploring);
  } else if (auto* saturating = std::get_if<SaturatingCost>(&terms_)) {
    saturating->setGoal(goal_feature);
  }
}

void DdmPlanCost::setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                             const Eigen::VectorXd& offset) {
  eigen_assert(!x.empty() && x.features().rows() == f_.featureDim() &&
               x.features().cols() == f_.order() && x.torques().rows() == f_.torqueDim() &&
               offset.size() == f_.featureDim());
  features_ = x.features().rowwise().reverse();
  torques_.leftCols(f_.order() - 1) = x.torques().rowwise().reverse();
  setGoal(goal_feature, exploring_);
  offset_ = offset;
}

void DdmPlanCost::rollOut(const Eigen::Ref<const Eigen::MatrixXd>& U, int num_steps) {
  const Eigen::Index target = f_.order();  // index of z_1 after the features of x_0
  torques_.rightCols(horizon_) = U;
  roll_out_.forward(theta_p_, features_, torques_, RollOut<double>::Targets(&target, 1), num_steps,
                    &offset_);
}

/// @return z_{num_steps}; z_0 is the current feature  [feature_dim]
Eigen::VectorXd DdmPlanCost::featureAfter(int num_steps) const {
  if (num_steps == 0) return features_.rightCols(1);
  return roll_out_.predicted(num_steps - 1);
}

/// @param z          feature to which the step leads                            [feature_dim]
/// @param torques    past and planned torques, as in torques_ [N m]
/// @param column     column of the torque of the step
/// @param d_z        out: derivative by z; null: skip                           [feature_dim]
/// @param d_torques  the derivative by `torques` is ADDED to it [1/(N m)]; null: skip
double DdmPlanCost::stepCost(const Eigen::Ref<const Eigen::VectorXd>& z,
                             const Eigen::MatrixXd& torques, Eigen::Index column,
                             Eigen::VectorXd* d_z, Eigen::MatrixXd* d_torques) const {
  const Eigen::Index before = std::max<Eigen::Index>(column - 1, 0);
  const auto u = torques.col(column).array();
  const SaturatingCost* saturating = saturatingCost();
  if (saturating == nullptr) {  // eq. (9)
    if (d_z != nullptr) *d_z = 2.0 * (z - goal_feature_);
    if (d_torques != nullptr) d_torques->col(column).array() += 2.0 * control_weight_ * u;
    return (z - goal_feature_).squaredNorm() + (control_weight_ * u.square()).sum();
  }
  const Eigen::ArrayXd change = u - torques.col(before).array();
  const double effort = (control_weight_ * (u.square() + kChangeWeight * change.square())).sum();
  const double near = 1.0 - saturating->evaluate(z, d_z);
  const double gentle = std::exp(-effort);
  if (d_z != nullptr) *d_z *= gentle;
  if (d_torques != nullptr) {
    const Eigen::ArrayXd factor = 2.0 * near * gentle * control_weight_;
    d_torques->col(column).array() += factor * (u + kChangeWeight * change);
    d_torques->col(before).array() -= factor * kChangeWeight * change;
  }
  return 1.0 - near * gentle;
}

double DdmPlanCost::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) {
  eigen_assert(U.rows() == f_.torqueDim() && U.cols() == horizon_);
  rollOut(U, horizon_);
  double cost = 0.0;
  for (int step = 0; step < horizon_; ++step) {
    cost += stepCost(roll_out_.predicted(step), torques_, f_.order() - 1 + step, nullptr, nullptr);
  }
  Eigen::VectorXd d_last, d_before;
  const auto* cost_to_go = std::get_if<CostToGo>(&terms_);
  if (cost_to_go != nullptr) {
    cost += cost_to_go->value(featureAfter(horizon_), featureAfter(horizon_ - 1),
                              d_U == nullptr ? nullptr : &d_last, &d_before);
  }
  if (d_U == nullptr) return cost;

  d_torques_.setZero(torques_.rows(), torques_.cols());
  for (int step = 0; step < horizon_; ++step) roll_out_.dPredicted(step).setZero();
  if (cost_to_go != nullptr) {
    roll_out_.dPredicted(horizon_ - 1) += d_last;
    if (horizon_ > 1) roll_out_.dPredicted(horizon_ - 2) += d_before;
  }
  const Eigen::Index target = f_.order();
  const RollOut<double>::Targets targets(&target, 1);
  for (int step = horizon_ - 1; step >= 0; --step) {
    stepCost(roll_out_.predicted(step), torques_, f_.order() - 1 + step, &d_step_, &d_torques_);
    roll_out_.dPredicted(step) += d_step_;
    roll_out_.backward(theta_p_, targets, step, nullptr, nullptr, &d_torques_);
  }
  *d_U = d_torques_.rightCols(horizon_);
  return cost;
}

/// @return each plan, continued by each combination of torques, held from step `begin` on for
///         `num_steps` steps
std::vector<DdmPlanCost::HeldPlan> DdmPlanCost::continued(const std::vector<HeldPlan>& plans,
                                                          int begin, int num_steps) {
  const Eigen::MatrixXd& choices = saturatingCost()->torques();
  const Eigen::Index order = f_.order(), length = order + num_steps;
  const auto count = static_cast<Eigen::Index>(plans.size()) * choices.cols();
  std::vector<HeldPlan> out;
  Eigen::MatrixXd Z(f_.featureDim(), count * length), U(f_.torqueDim(), count * length);
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1> targets(count);
  for (const HeldPlan& plan : plans) {
    for (Eigen::Index choice = 0; choice < choices.cols(); ++choice) {
      const Eigen::Index first = static_cast<Eigen::Index>(out.size()) * length;
      targets[static_cast<Eigen::Index>(out.size())] = first + order;
      out.push_back(plan);
      auto& torques = out.back().torques;
      torques.middleCols(order - 1 + begin, num_steps).colwise() = choices.col(choice);
      Z.middleCols(first, order) = plan.features;
      U.middleCols(first, length - 1) = torques.middleCols(begin, length - 1);
    }
  }
  search_.forward(theta_p_, Z, U, RollOut<double>::Targets(targets.data(), count), num_steps,
                  &offset_);
  for (Eigen::Index i = 0; i < count; ++i) {
    HeldPlan& plan = out[static_cast<size_t>(i)];
    Eigen::MatrixXd features(f_.featureDim(), length);
    features.leftCols(order) = plan.features;
    for (int step = 0; step < num_steps; ++step) {
      features.col(order + step) = search_.predicted(step).col(i);
      plan.cost += stepCost(search_.predicted(step).col(i), plan.torques, order - 1 + begin + step,
                            nullptr, nullptr);
    }
    plan.features = features.rightCols(order);
    plan.total = plan.cost;
    if (const auto* cost_to_go = std::get_if<CostToGo>(&terms_)) {
      plan.total +=
          cost_to_go->value(features.col(length - 1), features.col(length - 2), nullptr, nullptr);
    }
    if (std::isnan(plan.total)) plan.total = std::numeric_limits<double>::infinity();
  }
  return out;
}

std::optional<Eigen::MatrixXd> DdmPlanCost::proposal() {
  if (saturatingCost() == nullptr) return std::nullopt;
  const auto num_choices = static_cast<size_t>(saturatingCost()->torques().cols());
  const size_t most = std::holds_alternative<CostToGo>(terms_) ? 1 : num_choices * num_choices;
  const auto better = [](const HeldPlan& a, const HeldPlan& b) { return a.total < b.total; };
  torques_.rightCols(horizon_).setZero();
  std::vector<HeldPlan> plans = {{torques_, features_, 0.0, 0.0}};
  for (int begin = 0; begin < horizon_; begin += SaturatingCost::kHoldSteps) {
    plans = continued(plans, begin, std::min(SaturatingCost::kHoldSteps, horizon_ - begin));
    std::stable_sort(plans.begin(), plans.end(), better);
    if (plans.size() > most) plans.resize(most);
  }
  return plans.front().torques.rightCols(horizon_);
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
  if (model.torqueDim() > SaturatingCost::kMaxMotors) {
    throw std::invalid_argument(textOf("mpc/cost ", options.cost, " needs a model with at most ",
                                       SaturatingCost::kMaxMotors,
                                       " motors, as it compares 3^motors sets of torques, got ",
                                       model.torqueDim(), ": set mpc/cost to distance"));
  }
  if (model.info().support_states.cols() < 2) {
    throw std::invalid_argument("mpc/cost " + options.cost +
                                " needs a model with support states, and this one has none: "
                                "train it again from its bags, or set mpc/cost to distance");
  }
  const Eigen::VectorXd max_torque =
      perMotor(options.max_torque, model.torqueDim(), "mpc/max_torque");
  if (options.cost == "saturating") {
    return DdmPlanCost(model, options.horizon, options.control_weight,
                       SaturatingCost(model, max_torque, DdmPlanCost::kWidth));
  }
  return DdmPlanCost(model, options.horizon, options.control_weight, CostToGo(model, max_torque));
}

}  // namespace ddm
