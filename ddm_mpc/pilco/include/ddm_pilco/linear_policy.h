// Linear policy: u = W x + b before squashing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/policy.h"

namespace ddm {
namespace pilco {

/// M = W m + b,  S = W s W^T,  V = W^T (Deisenroth, 2010).
/// Parameters: W [U x D] by columns, then b [U].
class LinearPolicy : public Policy {
 public:
  /// @throws std::invalid_argument if a size is < 1
  LinearPolicy(int input_dim, int output_dim);

  int inputDim() const override { return static_cast<int>(weights_.cols()); }
  int outputDim() const override { return static_cast<int>(weights_.rows()); }
  Eigen::VectorXd parameters() const override { return parameters_; }
  void setParameters(const Eigen::VectorXd& parameters) override;
  Moments predict(const Gaussian& input) override;
  Gaussian backward(const Gaussian& input, const Moments& d_output,
                    Eigen::VectorXd* d_parameters) override;

 private:
  Eigen::VectorXd parameters_;
  Eigen::MatrixXd weights_;  // [U x D]
};

}  // namespace pilco
}  // namespace ddm
