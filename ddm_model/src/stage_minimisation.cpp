// Minimisation of one stage of a training schedule by BFGS, L-BFGS or preconditioned L-BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#include "stage_minimisation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>

namespace ddm {
namespace {

/// Damping d. Training takes about equally long from 0.01 to 0.3. Without damping, directions
/// without curvature would get unbounded steps.
constexpr double kDamping = 0.03;

/// @return (matrix + damping)^(-1/2); the identity if the matrix is 0 or has overflowed float
Eigen::MatrixXf inverseRoot(const Eigen::MatrixXd& matrix) {
  const Eigen::Index size = matrix.rows();
  const double mean = matrix.trace() / static_cast<double>(size);  // mean of the eigenvalues
  if (!(mean > 0.0) || !std::isfinite(mean)) return Eigen::MatrixXf::Identity(size, size);
  const Eigen::MatrixXd damped = matrix + kDamping * mean * Eigen::MatrixXd::Identity(size, size);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(damped).operatorInverseSqrt().cast<float>();
}

/// Iterations of L-BFGS between computations of the Kronecker factors; 25 to 100 do equally well.
constexpr int kRefresh = 50;

// Steps that L-BFGS stores. More steps come closer to BFGS, and iterations take longer. Few suffice
// between two computations of the Kronecker factors.
constexpr int kLbfgsRank = 20;
constexpr int kKfacRank = 10;

/// Range of the free parameters in theta, and the layers that they belong to.
struct Range {
  Eigen::Index begin;
  Eigen::Index size;
  int first_layer;
  int num_layers;
};

Range freeParameters(const Networks<float>& networks, Stage::Free free) {
  const Range auto_encoder{0, networks.numOfAutoEncoder(), 0,
                           networks.encoder().numLayers() + networks.decoder().numLayers()};
  const Range f{auto_encoder.size, networks.f().numParams(), auto_encoder.num_layers,
                networks.f().numLayers()};
  if (free == Stage::Free::kAutoEncoder) return auto_encoder;
  if (free == Stage::Free::kPredictor) return f;
  return {0, auto_encoder.size + f.size, 0, auto_encoder.num_layers + f.num_layers};
}

/// Scaled objective of one stage in float32, as a function of the free parameters or of coordinates
/// v.
class StageObjective {
 public:
  using Value = JointObjective<float>::Value;

  /// @param theta  all parameters; those that are not free stay at these values
  StageObjective(JointObjective<float>* objective, const Terms& terms, Range free,
                 const Eigen::VectorXd& theta)
      : objective_(*objective),
        terms_(terms),
        free_(free),
        theta_(theta.cast<float>()),
        origin_(freeOf(theta_)) {}

  double operator()(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    freeOf(theta_) = parametersAt(x);
    const Value value =
        objective_.evaluate(theta_, gradient != nullptr ? &d_theta_ : nullptr, terms_);
    const double cost = objective_.weight() * value.of(terms_);
    if (gradient != nullptr) {
      Eigen::VectorXf slope = freeOf(d_theta_);
      if (preconditioner_) slope = (*preconditioner_)(slope);
      *gradient = objective_.weight() * slope.cast<double>();
    }
    if (cost < lowest_) {
      lowest_ = cost;
      best_ = value;
    }
    return cost;
  }

  /// Computes new coordinates v from the Kronecker factors at x. They are 0 at x.
  void precondition(const Eigen::VectorXd& x, std::mt19937_64* rng) {
    origin_ = parametersAt(x);
    freeOf(theta_) = origin_;
    LayerFactors<float> factors = objective_.factors(theta_, terms_, rng);
    const auto first = factors.begin() + free_.first_layer;
    preconditioner_.emplace(LayerFactors<float>(first, first + free_.num_layers));
  }

  /// @return free parameters at coordinates x  [size of the range]
  Eigen::VectorXf parametersAt(const Eigen::VectorXd& x) const {
    if (!preconditioner_) return x.cast<float>();
    return origin_ + (*preconditioner_)(x.cast<float>());
  }

  /// @return V_R and V_P at the lowest cost so far
  const Value& best() const { return best_; }

 private:
  Eigen::VectorBlock<Eigen::VectorXf> freeOf(Eigen::VectorXf& theta) const {
    return theta.segment(free_.begin, free_.size);
  }

  JointObjective<float>& objective_;
  Terms terms_;
  Range free_;
  Eigen::VectorXf theta_;
  Eigen::VectorXf d_theta_;
  Eigen::VectorXf origin_;
  std::optional<Preconditioner> preconditioner_;  // empty: x are the free parameters
  double lowest_ = std::numeric_limits<double>::infinity();
  Value best_;
};

}  // namespace

Preconditioner::Preconditioner(const LayerFactors<float>& factors) {
  for (const KroneckerFactors<float>& layer : factors) {
    const double per_sample = 1.0 / static_cast<double>(layer.num_samples);
    layers_.push_back({inverseRoot(layer.errors.cast<double>()),
                       inverseRoot(per_sample * layer.inputs.cast<double>())});
  }
}

Eigen::VectorXf Preconditioner::operator()(const Eigen::VectorXf& v) const {
  Eigen::VectorXf out(v.size());
  Eigen::Index offset = 0;
  for (const Layer& layer : layers_) {
    const Eigen::Index rows = layer.left.rows(), cols = layer.right.rows();
    const Eigen::Map<const Eigen::MatrixXf> in(v.data() + offset, rows, cols);
    Eigen::Map<Eigen::MatrixXf>(out.data() + offset, rows, cols).noalias() =
        layer.left * (in * layer.right);
    offset += rows * cols;
  }
  return out;
}

SolverResult minimiseStage(const Stage& stage, const TrainingOptions& training,
                           const Networks<float>& networks, JointObjective<float>* objective,
                           Eigen::VectorXd* theta, const StageCallback& callback) {
  const Range free = freeParameters(networks, stage.free);
  StageObjective function(objective, stage.terms, free, *theta);
  const bool kfac = training.solver == "kfac";
  std::mt19937_64 rng(1);  // draws signs, see JointObjective::factors()
  const int cap = stage.max_iterations;
  MinimiseOptions options;
  // L-BFGS that stores all steps is BFGS, and fast if the steps are fewer than the parameters. More
  // steps than parameters are not stored, because the memory would have no bound.
  const int all_steps = std::min(cap, static_cast<int>(free.size));
  options.lbfgs_rank = training.solver == "bfgs" ? all_steps : kfac ? kKfacRank : kLbfgsRank;
  options.function_tolerance = training.function_tolerance;
  options.gradient_tolerance = 1e-9;
  SolverResult total;
  if (callback) {
    options.on_iteration = [&](SolverResult so_far) {
      so_far.iterations += total.iterations;
      return callback(so_far, function.best());
    };
  }
  Eigen::VectorXd x = theta->segment(free.begin, free.size);
  do {
    if (kfac) {
      function.precondition(x, &rng);
      x.setZero();
    }
    options.max_iterations = kfac ? std::min(kRefresh, cap - total.iterations) : cap;
    SolverResult result = minimise(std::ref(function), x, options);
    const bool found = std::isfinite(result.cost);
    if (found) {
      x = result.x;
      theta->segment(free.begin, free.size) = function.parametersAt(x).cast<double>();
    }
    if (total.evaluations > 0) {
      result.initial_cost = total.initial_cost;
      if (!found) result.cost = total.cost;  // the result before this round stays
    }
    result.iterations += total.iterations;
    result.evaluations += total.evaluations;
    total = std::move(result);
  } while (total.reason == TerminationReason::kIterationLimit && total.iterations < cap);
  return total;
}

}  // namespace ddm
