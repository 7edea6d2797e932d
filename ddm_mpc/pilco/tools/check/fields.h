// pilco_check: what cases of several kinds consist of, in the project's layout.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "check/case.h"
#include "ddm_pilco/gp_training.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"

namespace ddm::pilco::check {

constexpr Tolerance kClosedForm = absolute(1e-12);

/// What a file calls mean, covariance and gain of an output, in this order.
struct MomentField {
  std::string name;
  Tolerance tolerance;
};
using MomentFields = std::vector<MomentField>;

void compareMoments(Case* reference, const MomentFields& fields, const Moments& computed);

/// Compares the derivatives of these fields in mean m and covariance of the input, where the file
/// has them. They are vectorised by columns.
/// @param covariance  what the file calls the covariance of the input
/// @param backward    dJ/d outputs -> dJ/d input
void compareJacobians(Case* reference, const MomentFields& fields, const std::string& covariance,
                      int dim, int output_dim,
                      const std::function<Gaussian(const Moments&)>& backward);

struct GpData {
  Eigen::MatrixXd inputs;   ///< [D x n]
  Eigen::MatrixXd targets;  ///< [n x E]
};

/// The fields X and Y.
GpData readGpData(Case* reference);

/// Rows: log length-scales, log signal std, log noise std. One column for each output.
Hyperparameters readHyperparameters(Case* reference, const std::string& field, const GpData& data);
Eigen::MatrixXd toMatrix(const Hyperparameters& hyperparameters);

/// @throws std::invalid_argument where `loghyp` makes the covariance lose positive definiteness
GpModel usable(const GpFit& fit);

/// The GP of the data and the field loghyp.
GpModel readModel(Case* reference, const GpData& data);

/// Compares the field loghyp_init, and trains from there.
GpFit trainFromStart(Case* reference, const GpData& data);

/// Parameters of an RBF policy from their parts.
/// @param group  that the fields are in, with a slash
Eigen::VectorXd readParameters(Case* reference, int dim, int controls,
                               const std::string& group = "");
std::unique_ptr<RbfPolicy> readRbfPolicy(Case* reference, int dim, int controls);

}  // namespace ddm::pilco::check
