// Minimisation of one stage of a training schedule by BFGS, L-BFGS or preconditioned L-BFGS.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ddm_model/minimise.h"
#include "ddm_model/objective.h"
#include "ddm_model/schedule.h"

namespace ddm {

/// Symmetric matrix T of the coordinates v, theta = theta_0 + T v, of training/solver kfac. theta
/// are the parameters of several layers. For each layer with Kronecker factors A (inputs) and E
/// (errors),
///
///   [W b] = [W b]_0 + E'^(-1/2) V A'^(-1/2),   A' = A / N + d mean(eig(A / N)) I,   E' likewise
///
/// Before L-BFGS has measured curvature, its steps in v are those of K-FAC in theta (Martens and
/// Grosse, ICML 2015). If a factor is 0 or not finite, its power is replaced by I.
class Preconditioner {
 public:
  /// @param factors  of the layers, in the order of theta
  explicit Preconditioner(const LayerFactors<float>& factors);

  /// @param v  step in v, or gradient by theta   [P]
  /// @return   T v: step in theta, or gradient by v  [P]
  Eigen::VectorXf operator()(const Eigen::VectorXf& v) const;

 private:
  struct Layer {
    Eigen::MatrixXf left;   // E'^(-1/2)
    Eigen::MatrixXf right;  // A'^(-1/2)
  };
  std::vector<Layer> layers_;
};

/// Receives the best point so far with its V_R and V_P, after each iteration. Returning false ends
/// the stage.
using StageCallback =
    std::function<bool(const SolverResult& so_far, const JointObjective<float>::Value& value)>;

/// Minimises w times the terms of a stage over its free parameters.
/// @param theta     in: all parameters; out: the free parameters are at the minimum, or unchanged
///                  if the objective is not finite at the initial point             [P]
/// @param callback  may be empty
/// @return          result of the solver, in its own coordinates
SolverResult minimiseStage(const Stage& stage, const TrainingOptions& training,
                           const Networks<float>& networks, JointObjective<float>* objective,
                           Eigen::VectorXd* theta, const StageCallback& callback);

}  // namespace ddm
