// Coordinates in which the curvature of the objective is about the same in all directions.
// SPDX-License-Identifier: BSD-3-Clause
#include "preconditioner.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace ddm {
namespace {

/// d. Training is about equally fast from 0.01 to 0.3. Without damping, directions that have shown no curvature yet
/// would take unbounded steps.
constexpr double kDamping = 0.03;

/// The damped matrix to the power of -1/2; the identity where all is 0, or where errors have overflowed float.
Eigen::MatrixXf inverseRoot(const Eigen::MatrixXd& matrix) {
  const Eigen::Index size = matrix.rows();
  const double mean = matrix.trace() / static_cast<double>(size);  // of the eigenvalues
  if (!(mean > 0.0) || !std::isfinite(mean)) return Eigen::MatrixXf::Identity(size, size);
  const Eigen::MatrixXd damped = matrix + kDamping * mean * Eigen::MatrixXd::Identity(size, size);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(damped).operatorInverseSqrt().cast<float>();
}

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

}  // namespace ddm
