// pilco_check: moments of policies before and after squashing, and their gradients.
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "check/kinds.h"
#include "ddm_pilco/linear_policy.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

constexpr Tolerance kPolicy = absolute(1e-9);

std::unique_ptr<Policy> readRbfPolicy(Case* reference, int input_dim, int output_dim) {
  const Eigen::MatrixXd centres = reference->matrix("centres");
  const int num_centres = static_cast<int>(centres.rows());
  reference->requireCount("nc", num_centres);
  auto policy = std::make_unique<RbfPolicy>(input_dim, output_dim, num_centres);
  policy->setParameters(
      RbfPolicy::packParameters(reference->matrix("log_ls", input_dim, output_dim),
                                reference->matrix("centres", num_centres, input_dim).transpose(),
                                reference->matrix("targets", num_centres, output_dim)));
  return policy;
}

std::unique_ptr<Policy> readLinearPolicy(Case* reference, int input_dim, int output_dim) {
  auto policy = std::make_unique<LinearPolicy>(input_dim, output_dim);
  const Eigen::MatrixXd weights = reference->matrix("w", output_dim, input_dim);
  Eigen::VectorXd parameters(weights.size() + output_dim);
  parameters << Eigen::Map<const Eigen::VectorXd>(weights.data(), weights.size()),
      reference->vector("b", output_dim);
  policy->setParameters(parameters);
  return policy;
}

std::unique_ptr<Policy> readPolicy(Case* reference, int input_dim, int output_dim) {
  const std::string kind = reference->text("kind");
  if (kind == "congp") return readRbfPolicy(reference, input_dim, output_dim);
  if (kind != "conlin") reference->fail("kind", "must be congp or conlin, got " + kind);
  return readLinearPolicy(reference, input_dim, output_dim);
}

void compareMoments(Case* reference, const std::string& suffix, const Moments& computed) {
  reference->compareVector("M" + suffix, computed.mean, kPolicy);
  reference->compareMatrix("S" + suffix, computed.covariance, kPolicy);
  reference->compareMatrix("C" + suffix, computed.gain, kPolicy);
}

/// Gradient of squashed mean ("M_sq") or variance ("S_sq") in the parameters of an RBF policy with
/// one control.
void compareGradient(Case* reference, const std::string& name, const Eigen::VectorXd& gradient,
                     Eigen::Index dim) {
  const Eigen::Index num_centres = (gradient.size() - dim) / (dim + 1);
  const Eigen::Map<const Eigen::MatrixXd> centres(gradient.data() + dim, num_centres, dim);
  reference->compareVector("d" + name + "_dlog_ls", gradient.head(dim), kPolicy);
  reference->compareMatrix("d" + name + "_dcentres", centres, kPolicy);
  reference->compareVector("d" + name + "_dtargets", gradient.tail(num_centres), kPolicy);
}

void compareGradients(Case* reference, SquashedPolicy* policy, const Gaussian& input) {
  if (!reference->hasGroup({"dM_sq_dlog_ls", "dM_sq_dcentres", "dM_sq_dtargets", "dS_sq_dlog_ls",
                            "dS_sq_dcentres", "dS_sq_dtargets"})) {
    return;
  }
  if (policy->outputDim() != 1 || reference->text("kind") != "congp") {
    reference->fail("dM_sq_dlog_ls", "is known for RBF policies with one control only");
  }
  for (const bool of_mean : {true, false}) {
    Moments seed = constantMoments(policy->inputDim(), 1);
    (of_mean ? seed.mean[0] : seed.covariance(0, 0)) = 1.0;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(policy->numParameters());
    policy->backward(input, seed, &gradient);
    compareGradient(reference, of_mean ? "M_sq" : "S_sq", gradient, policy->inputDim());
  }
}

}  // namespace

void checkPolicy(Case* reference) {
  const int dim = reference->count("D");
  const int controls = reference->count("U");
  const Gaussian input = {reference->vector("m", dim), reference->covariance("s", dim)};
  std::unique_ptr<Policy> policy = readPolicy(reference, dim, controls);
  compareMoments(reference, "", policy->predict(input));
  SquashedPolicy squashed(std::move(policy), reference->vector("maxU", controls));
  compareMoments(reference, "_sq", squashed.predict(input));
  compareGradients(reference, &squashed, input);
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
