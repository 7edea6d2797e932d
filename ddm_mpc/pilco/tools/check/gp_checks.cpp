// pilco_check: prediction of full and sparse GPs at a Gaussian input.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/gp_fields.h"
#include "check/jacobian.h"
#include "check/kinds.h"
#include "ddm_pilco/gp_moments.h"
#include "ddm_pilco/sparse_gp.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

void requireSizes(Case* reference, const GpData& data) {
  reference->requireCount("D", data.inputs.rows());
  reference->requireCount("E", data.targets.cols());
  reference->requireCount("n", data.inputs.cols());
}

void compareJacobian(Case* reference, const std::string& name, const Jacobian& computed,
                     double limit) {
  const Eigen::Index dim = computed.mean.cols();
  const std::string in_covariance = "d" + name + "ds";
  reference->compareMatrix("d" + name + "dm", computed.mean, relative(limit));
  const Eigen::MatrixXd from_file =
      reference->matrix(in_covariance, computed.mean.rows(), dim * dim);
  reference->compare(in_covariance, symmetrized(from_file, dim), computed.covariance,
                     relative(limit));
}

void comparePrediction(Case* reference, const GpModel& model) {
  GpMoments moments(model);
  const int dim = model.inputDim();
  const Gaussian input = {reference->vector("m", dim), reference->covariance("s", dim)};
  GpMoments::Tape tape;
  const Moments output = moments.predict(input, &tape);
  reference->compareVector("M", output.mean, relative(1e-10));
  reference->compareMatrix("S", output.covariance, relative(1e-9));
  reference->compareMatrix("V", output.gain, relative(1e-10));
  if (!reference->hasGroup({"dMdm", "dSdm", "dVdm", "dMds", "dSds", "dVds"})) return;
  const auto backward = [&](const Moments& seed) { return moments.backward(tape, seed); };
  Moments seed = constantMoments(dim, model.outputDim());
  compareJacobian(reference, "M", jacobian(&seed, &seed.mean, dim, backward), 1e-10);
  compareJacobian(reference, "S", jacobian(&seed, &seed.covariance, dim, backward), 1e-9);
  compareJacobian(reference, "V", jacobian(&seed, &seed.gain, dim, backward), 1e-10);
}

}  // namespace

void checkGpPredict(Case* reference) {
  const GpData data = readGpData(reference);
  requireSizes(reference, data);
  const Hyperparameters hyperparameters = readHyperparameters(reference, "loghyp", data);
  comparePrediction(reference,
                    usable(makeGpModel(data.inputs, data.targets, hyperparameters), *reference));
}

void checkSparseGpPredict(Case* reference) {
  const GpData data = readGpData(reference);
  requireSizes(reference, data);
  const Hyperparameters hyperparameters = readHyperparameters(reference, "loghyp", data);
  const Eigen::MatrixXd inducing = reference->matrix("Z").transpose();
  reference->requireCount("np", inducing.cols());
  const double ridge = reference->number("ridge");
  comparePrediction(reference, usable(makeSparseGpModel(inducing, data.inputs, data.targets,
                                                        hyperparameters, ridge),
                                      *reference));
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
