// Oracle: the paper's MPC with the true plant as model and with its true state.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/random_stream.h>
#include <ddm_mpc/planner.h>
#include <ddm_sim/plant.h>

#include <utility>

#include "method.h"

namespace ddm {
namespace {

constexpr double kStep = 1e-5;  // step of central differences, in the units of state and torque

/// Jacobian df/dx by central differences.
/// @param f  function of a vector
/// @return   df/dx  [f's size x x's size]
template <class Function>
Eigen::MatrixXd jacobian(const Function& f, const Eigen::VectorXd& x) {
  Eigen::MatrixXd out;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Eigen::VectorXd above = x;
    Eigen::VectorXd below = x;
    above[i] += kStep;
    below[i] -= kStep;
    const Eigen::VectorXd slope = (f(above) - f(below)) / (2.0 * kStep);
    if (i == 0) out.resize(slope.size(), x.size());
    out.col(i) = slope;
  }
  return out;
}

class OraclePlanCost : public PlanCost {
 public:
  OraclePlanCost(const Plant& plant, std::unique_ptr<Plant> model, int horizon,
                 double control_weight)
      : plant_(plant),
        model_(std::move(model)),
        horizon_(horizon),
        control_weight_(control_weight),
        states_(plant.stateDim(), horizon + 1),
        positions_(goalFeature().size(), horizon + 1) {}

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override {
    const Eigen::VectorXd goal = goalFeature();
    states_.col(0) = plant_.state();
    positions_.col(0) = model_->visiblePosition(states_.col(0));
    for (int k = 0; k < horizon_; ++k) {
      states_.col(k + 1) = next(states_.col(k), U.col(k));
      positions_.col(k + 1) = model_->visiblePosition(states_.col(k + 1));
    }
    const double cost = control_weight_ * U.squaredNorm() +
                        (positions_.rightCols(horizon_).colwise() - goal).squaredNorm();
    if (d_U == nullptr) return cost;

    *d_U = 2.0 * control_weight_ * U;
    Eigen::VectorXd d_state = Eigen::VectorXd::Zero(states_.rows());
    for (int k = horizon_ - 1; k >= 0; --k) {
      const Eigen::VectorXd state = states_.col(k);
      const Eigen::VectorXd u = U.col(k);
      const auto position = [this](const Eigen::VectorXd& s) { return model_->visiblePosition(s); };
      d_state +=
          2.0 * jacobian(position, states_.col(k + 1)).transpose() * (positions_.col(k + 1) - goal);
      const auto by_torque = [this, &state](const Eigen::VectorXd& v) { return next(state, v); };
      const auto by_state = [this, &u](const Eigen::VectorXd& s) { return next(s, u); };
      d_U->col(k) += jacobian(by_torque, u).transpose() * d_state;
      d_state = jacobian(by_state, state).transpose() * d_state;
    }
    return cost;
  }

  Eigen::MatrixXd predictedFeatures() const override { return positions_; }
  Eigen::VectorXd goalFeature() const override { return model_->visiblePosition(plant_.goal()); }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return plant_.torqueDim(); }

 private:
  Eigen::VectorXd next(const Eigen::VectorXd& state, const Eigen::VectorXd& u) const {
    model_->setState(state);
    model_->step(u);
    return model_->state();
  }

  const Plant& plant_;
  std::unique_ptr<Plant> model_;
  int horizon_;
  double control_weight_;
  Eigen::MatrixXd states_;     // state_0 ... state_K
  Eigen::MatrixXd positions_;  // p_0 ... p_K
};

/// Plans from the true state of the plant; ignores the image.
class OraclePolicy : public Policy {
 public:
  OraclePolicy(const Configuration& configuration, const Plant& plant)
      : cost_(plant, makePlant(*configuration.plant), configuration.mpc.horizon,
              configuration.mpc.control_weight),
        planner_(&cost_, configuration.mpc) {}

  void startTrial(const TrialId& id) override {
    planner_.clear();
    rng_ = randomStream(id, StreamRole::kPlannerStarts);
  }
  void observe(const Image& /*image*/) override {}
  Answer answer() override { return answerWith(planner_.solve(&rng_)); }
  void apply(const Eigen::VectorXd& /*u*/) override {}

 private:
  OraclePlanCost cost_;
  Planner planner_;
  std::mt19937_64 rng_;
};

/// Plans with the planner of the DDM. The oracle learns nothing, so that the column frames of its
/// trials.csv is 0.
class OracleMethod : public Method {
 public:
  OracleMethod(const Configuration& configuration, const Plant& plant)
      : configuration_(configuration), plant_(plant) {}

  TrainingOutcome train(const std::vector<std::string>& /*bags*/, const TrialId& /*id*/,
                        const PhaseCallback& progress) override {
    progress(1.0);
    return {};
  }
  std::shared_ptr<Policy> policy() const override {
    return std::make_shared<OraclePolicy>(configuration_, plant_);
  }

 private:
  const Configuration& configuration_;
  const Plant& plant_;
};

}  // namespace

std::unique_ptr<PlanCost> makeOracleCost(const Plant& plant, std::unique_ptr<Plant> model,
                                         int horizon, double control_weight) {
  return std::make_unique<OraclePlanCost>(plant, std::move(model), horizon, control_weight);
}

std::unique_ptr<Method> makeOracleMethod(const Configuration& configuration, const Plant& plant) {
  return std::make_unique<OracleMethod>(configuration, plant);
}

}  // namespace ddm
