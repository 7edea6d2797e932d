// Helpers around moments: filling, symmetry, checks of sizes.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/moments.h"

#include <stdexcept>
#include <string>

namespace ddm {
namespace pilco {
namespace {

void requireShape(const Eigen::Ref<const Eigen::MatrixXd>& matrix, Eigen::Index rows,
                  Eigen::Index cols, const char* who, const char* what) {
  if (matrix.rows() == rows && matrix.cols() == cols) return;
  const auto shape = [](Eigen::Index r, Eigen::Index c) {
    return "[" + std::to_string(r) + " x " + std::to_string(c) + "]";
  };
  throw std::invalid_argument(std::string(who) + ": " + what + " must be " + shape(rows, cols) +
                              ", got " + shape(matrix.rows(), matrix.cols()));
}

}  // namespace

Moments constantMoments(int input_dim, int output_dim, double value) {
  return Moments{Eigen::VectorXd::Constant(output_dim, value),
                 Eigen::MatrixXd::Constant(output_dim, output_dim, value),
                 Eigen::MatrixXd::Constant(input_dim, output_dim, value)};
}

Gaussian constantGaussian(int dim, double value) {
  return Gaussian{Eigen::VectorXd::Constant(dim, value),
                  Eigen::MatrixXd::Constant(dim, dim, value)};
}

Eigen::MatrixXd symmetricPart(const Eigen::MatrixXd& A) { return 0.5 * (A + A.transpose()); }

void requireSize(const Gaussian& input, int dim, const char* who) {
  requireShape(input.mean, dim, 1, who, "the mean of the input");
  requireShape(input.covariance, dim, dim, who, "the covariance of the input");
}

void requireSize(const Moments& d_output, int input_dim, int output_dim, const char* who) {
  requireShape(d_output.mean, output_dim, 1, who, "the derivative in the mean");
  requireShape(d_output.covariance, output_dim, output_dim, who,
               "the derivative in the covariance");
  requireShape(d_output.gain, input_dim, output_dim, who, "the derivative in the gain");
}

}  // namespace pilco
}  // namespace ddm
