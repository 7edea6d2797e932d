// Cost-to-go: value iteration of the learned model over the support states of its training data.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/cost_to_go.h"

#include <ddm_model/roll_out.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ddm {
namespace {

constexpr double kGamma = 0.99;                  // a cost 100 steps ahead still counts a third
constexpr double kWorst = 1.0 / (1.0 - kGamma);  // V_max: the goal is never reached
constexpr double kOptimism = 0.8;                // V_0 / V_max during exploration
constexpr double kSmoothness = 1.4;              // h / mean distance between neighbours
constexpr double kSmallestWeight = 1e-4;         // smallest weight of a support state in an Outcome
constexpr int kMaxSweeps = 1000;                 // cap on the sweeps that compare all torques
constexpr int kPolicySweeps = 20;                // sweeps with the best torques after each of them
constexpr double kTolerance = 1e-3;              // the iteration ends if no V_i changes by more
// w_0, the kernel's weight at a distance of 3 h.
const double kUnknown = std::exp(-0.5 * 3.0 * 3.0);

/// @return mean distance of a point to its nearest neighbour
double spacing(const Eigen::MatrixXd& points) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::RowVectorXd distances = (points.colwise() - points.col(i)).colwise().norm();
    distances[i] = std::numeric_limits<double>::infinity();
    sum += distances.minCoeff();
  }
  return sum / static_cast<double>(points.cols());
}

/// @return z_t - z_{t-1} of the support states; zero if a state has a single feature
///         [feature_dim x M]
Eigen::MatrixXd changesOf(const Ddm& model) {
  const Eigen::MatrixXd X = model.info().support_states.cast<double>();
  const Eigen::Index dim = model.featureDim();
  if (model.options().order == 1) return Eigen::MatrixXd::Zero(dim, X.cols());
  return X.topRows(dim) - X.middleRows(dim, dim);
}

/// @return root mean square of the changes. Infinite if nothing changes: states then differ only in
///         their features
double changeSpreadOf(const Ddm& model) {
  const Eigen::MatrixXd changes = changesOf(model);
  if (changes.isZero(0.0)) return std::numeric_limits<double>::infinity();
  return changes.norm() / std::sqrt(changes.cols());
}

/// @param change  spread of the changes / spread of the features
double widthInPlan(double change) {
  const double half = std::isfinite(change) ? 0.5 * change : 0.0;
  return std::max(CostToGo::kSmallestWidthInPlan, half);
}

/// Predicts from all support states under the same torques.
/// @param X  support states, see ModelInfo        [state_dim x M]
/// @param u  torques [N m]                            [torque_dim]
/// @return   features after each step, each     [feature_dim x M]
std::vector<Eigen::MatrixXd> predictions(const Ddm& model, const Eigen::MatrixXd& X,
                                         const Eigen::VectorXd& u, int num_steps) {
  const Eigen::Index dim = model.featureDim(), motors = model.torqueDim(), M = X.cols();
  const Eigen::Index n = model.options().order;
  const Eigen::Index length = n + num_steps;  // samples of a support state in Z and U, oldest first
  Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(dim, M * length);
  Eigen::MatrixXd U = u.replicate(1, M * length);
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1> targets(M);
  for (Eigen::Index i = 0; i < M; ++i) {
    const Eigen::Index last = i * length + n - 1;
    for (Eigen::Index lag = 0; lag < n; ++lag) Z.col(last - lag) = X.col(i).segment(lag * dim, dim);
    for (Eigen::Index lag = 0; lag < n - 1; ++lag) {
      U.col(last - 1 - lag) = X.col(i).segment(n * dim + lag * motors, motors);
    }
    targets[i] = last + 1;
  }
  RollOut<double> roll_out(model.predictionModel());
  roll_out.forward(model.thetaP(), Z, U, RollOut<double>::Targets(targets.data(), M), num_steps);
  std::vector<Eigen::MatrixXd> steps;
  for (int step = 0; step < num_steps; ++step) steps.push_back(roll_out.predicted(step));
  return steps;
}

}  // namespace

CostToGo::CostToGo(const Ddm& model, const Eigen::VectorXd& max_torque)
    : model_(&model),
      cost_in_v_(model, max_torque, kWidth),
      change_spread_(changeSpreadOf(model)),
      step_cost_(model, max_torque, widthInPlan(change_spread_ / cost_in_v_.spread())) {}

void CostToGo::predictOutcomes() {
  const Eigen::MatrixXd X = model_->info().support_states.cast<double>();
  const Eigen::Index dim = model_->featureDim(), M = X.cols();
  points_.resize(2 * dim, M);
  points_ << X.topRows(dim) / cost_in_v_.spread(), changesOf(*model_) / change_spread_;
  h_ = kSmoothness * spacing(points_);
  outcomes_.resize(static_cast<size_t>(M));
  for (Eigen::Index i = 0; i < cost_in_v_.torques().cols(); ++i) {
    const auto steps = predictions(*model_, X, cost_in_v_.torques().col(i), kHoldSteps);
    Eigen::MatrixXd path(dim, kHoldSteps);
    for (Eigen::Index state = 0; state < M; ++state) {
      for (int step = 0; step < kHoldSteps; ++step) path.col(step) = steps[step].col(state);
      outcomes_[static_cast<size_t>(state)].push_back(outcomeOf(path));
    }
  }
}

Eigen::VectorXd CostToGo::pointOf(const Eigen::Ref<const Eigen::VectorXd>& z,
                                  const Eigen::Ref<const Eigen::VectorXd>& before) const {
  Eigen::VectorXd point(2 * z.size());
  point << z / cost_in_v_.spread(), (z - before) / change_spread_;
  return point;
}

Eigen::ArrayXd CostToGo::kernel(const Eigen::VectorXd& point) const {
  const Eigen::ArrayXd squared =
      (points_.colwise() - point).colwise().squaredNorm().transpose().array();
  return (squared * (-0.5 / (h_ * h_))).exp();
}

CostToGo::Outcome CostToGo::outcomeOf(const Eigen::MatrixXd& path) const {
  Outcome outcome{path, {}, {}};
  const Eigen::ArrayXd weights =
      kernel(pointOf(path.col(kHoldSteps - 1), path.col(kHoldSteps - 2)));
  double sum = kUnknown;
  for (Eigen::Index j = 0; j < weights.size(); ++j) {
    if (!(weights[j] > kSmallestWeight)) continue;
    outcome.neighbours.push_back(static_cast<int>(j));
    outcome.weights.push_back(weights[j]);
    sum += weights[j];
  }
  for (double& weight : outcome.weights) weight /= sum;
  return outcome;
}

/// @return V_0
double CostToGo::unknownValue() const { return exploring_ ? kOptimism * kWorst : kWorst; }

void CostToGo::setGoal(const Eigen::VectorXd& z_ref, bool exploring) {
  if (outcomes_.empty()) predictOutcomes();
  step_cost_.setGoal(z_ref);
  cost_in_v_.setGoal(z_ref);
  exploring_ = exploring;
  const auto costOf = [this](const Outcome& outcome) {
    double cost = 0.0, discount = 1.0;
    for (int step = 0; step < kHoldSteps; ++step, discount *= kGamma) {
      cost += discount * cost_in_v_.evaluate(outcome.path.col(step), nullptr);
    }
    return cost;
  };
  std::vector<std::vector<double>> costs;
  for (const std::vector<Outcome>& outcomes : outcomes_) {
    costs.emplace_back();
    for (const Outcome& outcome : outcomes) costs.back().push_back(costOf(outcome));
  }
  iterate(costs);
}

/// Modified policy iteration. A sweep that compares all torques takes 3^torque_dim times as long as
/// a sweep with the best torques of the last comparison, and the best torques soon stop changing.
/// @param costs  discounted sum of step costs, for each support state and combination of torques
void CostToGo::iterate(const std::vector<std::vector<double>>& costs) {
  const double discount = std::pow(kGamma, kHoldSteps), unknown = unknownValue();
  values_.setConstant(points_.cols(), kWorst);
  const auto valueOf = [&](size_t i, size_t k) {
    const Outcome& outcome = outcomes_[i][k];
    double gain = 0.0;  // how far known neighbours are better than V_0
    for (size_t j = 0; j < outcome.neighbours.size(); ++j) {
      gain += outcome.weights[j] * (unknown - values_[outcome.neighbours[j]]);
    }
    return costs[i][k] + discount * (unknown - gain);
  };
  const auto set = [this](size_t i, double value) {
    const double change = std::abs(value - values_[static_cast<Eigen::Index>(i)]);
    values_[static_cast<Eigen::Index>(i)] = value;
    return change;
  };
  std::vector<size_t> best(outcomes_.size(), 0);
  double change = std::numeric_limits<double>::infinity();
  for (int sweep = 0; sweep < kMaxSweeps && change > kTolerance; ++sweep) {
    change = 0.0;
    for (size_t i = 0; i < outcomes_.size(); ++i) {
      double least = std::numeric_limits<double>::infinity();
      for (size_t k = 0; k < outcomes_[i].size(); ++k) {
        const double value = valueOf(i, k);
        if (value < least) {
          least = value;
          best[i] = k;
        }
      }
      change = std::max(change, set(i, std::min(least, kWorst)));
    }
    double followed = change;
    for (int i = 0; i < kPolicySweeps && followed > kTolerance; ++i) {
      followed = 0.0;
      for (size_t j = 0; j < outcomes_.size(); ++j) {
        followed = std::max(followed, set(j, std::min(valueOf(j, best[j]), kWorst)));
      }
    }
  }
}

double CostToGo::value(const Eigen::Ref<const Eigen::VectorXd>& z,
                       const Eigen::Ref<const Eigen::VectorXd>& before, Eigen::VectorXd* d_z,
                       Eigen::VectorXd* d_before) const {
  const Eigen::VectorXd point = pointOf(z, before);
  const Eigen::ArrayXd weights = kernel(point);
  const double sum = kUnknown + weights.sum();
  const double value = (kUnknown * unknownValue() + (weights * values_).sum()) / sum;
  if (d_z != nullptr) {
    // dw_i/dp = w_i (p_i - p) / h^2
    const Eigen::VectorXd share = weights * (values_ - value) / (sum * h_ * h_);
    const Eigen::VectorXd d_point = points_ * share - point * share.sum();
    *d_before = -d_point.tail(z.size()) / change_spread_;
    *d_z = d_point.head(z.size()) / cost_in_v_.spread() - *d_before;
  }
  return value;
}

}  // namespace ddm
