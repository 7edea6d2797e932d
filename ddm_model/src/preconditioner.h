// Coordinates in which the curvature of the objective is about the same in all directions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/kronecker_factors.h"

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

}  // namespace ddm
