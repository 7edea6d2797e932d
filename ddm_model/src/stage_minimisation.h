// One stage of a training schedule, minimised by BFGS, or by L-BFGS, preconditioned or not.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ddm_model/minimise.h"
#include "ddm_model/objective.h"
#include "ddm_model/schedule.h"

namespace ddm {

/// T of theta = theta_0 + T v, where theta are the parameters of some layers one after the other. For each layer,
/// with its Kronecker factors A (of inputs) and E (of errors),
///
///   [W b] = [W b]_0 + E'^(-1/2) V A'^(-1/2),   A' = A / N + d mean(eig(A / N)) I,   E' likewise
///
/// so that steps of L-BFGS in v are those of K-FAC in theta (Martens and Grosse, ICML 2015) as long as it has seen
/// no curvature itself. T is symmetric. The power of a factor that is 0 or not finite counts as I.
class Preconditioner {
 public:
  /// @param factors  of the layers whose parameters theta are
  explicit Preconditioner(const LayerFactors<float>& factors);

  /// @param v  step in v, or derivative of the objective by theta    [P]
  /// @return   T v: step in theta, or derivative of the objective by v  [P]
  Eigen::VectorXf operator()(const Eigen::VectorXf& v) const;

 private:
  struct Layer {
    Eigen::MatrixXf left;   // E'^(-1/2)
    Eigen::MatrixXf right;  // A'^(-1/2)
  };
  std::vector<Layer> layers_;
};

/// Called after each iteration with the best point so far and V_R, V_P there; false ends the stage.
using StageCallback =
    std::function<bool(const Minimum& so_far, const JointObjective<float>::Value& value)>;

/// Minimises w times the terms of the stage over the parameters that it leaves free.
/// @param theta     in: all parameters, out: with the free ones at the minimum; as they were if the
///                  objective cannot be evaluated there                            [P]
/// @param callback  may be empty
Minimum minimiseStage(const Stage& stage, const TrainingOptions& training,
                      const Networks<float>& networks, JointObjective<float>* objective,
                      Eigen::VectorXd* theta, const StageCallback& callback);

}  // namespace ddm
