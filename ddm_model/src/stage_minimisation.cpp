// One stage of a training schedule, minimised by BFGS or L-BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "stage_minimisation.h"

#include <limits>

namespace ddm {
namespace {

/// Where the parameters that a stage may change lie in theta.
struct Range {
  Eigen::Index begin;
  Eigen::Index size;
};

Range freeParameters(const Networks<float>& networks, Stage::Free free) {
  const Eigen::Index num_params = networks.numParams();
  const Eigen::Index num_auto_encoder = num_params - networks.f().numParams();
  switch (free) {
    case Stage::Free::kAutoEncoder:
      return {0, num_auto_encoder};
    case Stage::Free::kPredictor:
      return {num_auto_encoder, num_params - num_auto_encoder};
    case Stage::Free::kAll:
      break;
  }
  return {0, num_params};
}

/// The scaled objective of one stage in float32, as a function of the free parameters.
class StageObjective {
 public:
  using Value = JointObjective<float>::Value;

  /// @param theta  all parameters; gives the values of those that are not free
  StageObjective(JointObjective<float>* objective, const Terms& terms, Range free,
                 const Eigen::VectorXd& theta)
      : objective_(*objective), terms_(terms), free_(free), theta_(theta.cast<float>()) {}

  double operator()(const Eigen::VectorXd& free, Eigen::VectorXd* gradient) {
    theta_.segment(free_.begin, free_.size) = free.cast<float>();
    const Value value =
        objective_.evaluate(theta_, gradient != nullptr ? &d_theta_ : nullptr, terms_);
    const double cost = objective_.weight() * value.of(terms_);
    if (gradient != nullptr) {
      *gradient = objective_.weight() * d_theta_.segment(free_.begin, free_.size).cast<double>();
    }
    if (cost < lowest_) {
      lowest_ = cost;
      best_ = value;
    }
    return cost;
  }

  /// V_R and V_P where the cost was lowest.
  const Value& best() const { return best_; }

 private:
  JointObjective<float>& objective_;
  Terms terms_;
  Range free_;
  Eigen::VectorXf theta_;
  Eigen::VectorXf d_theta_;
  double lowest_ = std::numeric_limits<double>::infinity();
  Value best_;
};

}  // namespace

int iterationCap(const Stage& stage, const TrainingOptions& training) {
  return stage.warm_up ? training.warm_up_iterations : training.max_iterations;
}

Minimum minimiseStage(const Stage& stage, const TrainingOptions& training,
                      const Networks<float>& networks, JointObjective<float>* objective,
                      Eigen::VectorXd* theta, const StageCallback& callback) {
  const Range free = freeParameters(networks, stage.free);
  StageObjective function(objective, stage.terms, free, *theta);
  MinimiseOptions options;
  options.lbfgs_rank = training.solver == "bfgs" ? 0 : training.lbfgs_rank;
  options.max_iterations = iterationCap(stage, training);
  options.function_tolerance = training.function_tolerance;
  options.gradient_tolerance = 1e-9;
  if (callback) {
    options.on_iteration = [&](const Minimum& so_far) { return callback(so_far, function.best()); };
  }
  const Minimum minimum =
      minimise(std::ref(function), theta->segment(free.begin, free.size), options);
  theta->segment(free.begin, free.size) = minimum.x;
  return minimum;
}

}  // namespace ddm
