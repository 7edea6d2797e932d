// Interface of a policy before squashing: moments of its control and their derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/moments.h"

namespace ddm::pilco {

/// A map from features of the state to controls of any size, with parameters in one flat vector.
class Policy {
 public:
  virtual ~Policy() = default;

  virtual int inputDim() const = 0;
  virtual int outputDim() const = 0;

  /// A copy: a search that starts from them must not see its start change.
  virtual Eigen::VectorXd parameters() const = 0;
  int numParameters() const { return static_cast<int>(parameters().size()); }

  /// @throws std::invalid_argument for a wrong number of parameters
  virtual void setParameters(const Eigen::VectorXd& parameters) = 0;

  /// @throws std::invalid_argument for a wrong input dimension
  virtual Moments predict(const Gaussian& input) = 0;

  /// Vector-Jacobian product of predict() at the same input.
  /// @param d_output      dJ/dM, dJ/dS, dJ/dV
  /// @param d_parameters  (optional) dJ/d parameters is ADDED to it
  /// @return              dJ/dm, dJ/ds (symmetric)
  virtual Gaussian backward(const Gaussian& input, const Moments& d_output,
                            Eigen::VectorXd* d_parameters) = 0;
};

}  // namespace ddm::pilco
