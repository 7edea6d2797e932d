// pilco_check: GPs from the fields of a case.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "check/case.h"
#include "ddm_pilco/gp_model.h"
#include "ddm_pilco/gp_training.h"

namespace ddm {
namespace pilco {
namespace check {

/// Training data, in the project's layout.
struct GpData {
  Eigen::MatrixXd inputs;   ///< [D x n]
  Eigen::MatrixXd targets;  ///< [n x E]
};

/// The fields X and Y.
inline GpData readGpData(Case* reference) {
  GpData data;
  data.inputs = reference->matrix("X").transpose();
  data.targets = reference->matrix("Y");
  if (data.targets.rows() != data.inputs.cols()) {
    reference->fail("Y", "must have as many rows as X");
  }
  return data;
}

/// Rows: log length-scales, log signal std, log noise std. One column for each output.
inline Hyperparameters readHyperparameters(Case* reference, const std::string& field,
                                           const GpData& data) {
  const Eigen::Index dim = data.inputs.rows();
  const Eigen::MatrixXd values = reference->matrix(field, dim + 2, data.targets.cols());
  return {values.topRows(dim), values.row(dim).transpose(), values.row(dim + 1).transpose()};
}

inline Eigen::MatrixXd toMatrix(const Hyperparameters& hyperparameters) {
  const Eigen::Index dim = hyperparameters.log_length_scales.rows();
  Eigen::MatrixXd out(dim + 2, hyperparameters.log_signal_std.size());
  out << hyperparameters.log_length_scales, hyperparameters.log_signal_std.transpose(),
      hyperparameters.log_noise_std.transpose();
  return out;
}

/// @throws CaseError where `loghyp` makes the covariance lose positive definiteness
inline GpModel usable(const GpFit& fit, const Case& reference) {
  if (!fit.ok) reference.fail("loghyp", fit.message);
  return fit.model;
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
