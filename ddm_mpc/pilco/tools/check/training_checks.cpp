// pilco_check: the marginal likelihood and the training on it.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "check/gp_fields.h"
#include "check/kinds.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

/// The likelihood of one output at some hyper-parameters, without and with the curb.
struct Likelihood {
  Likelihood(const GpData& data, int output, const Eigen::VectorXd& theta) {
    const GpTrainingOptions options;
    plain = negativeLogLikelihood(data.inputs, data.targets.col(output), theta, &gradient);
    curbed_gradient = gradient;
    curbed = plain + curb(theta, sampleStd(data.inputs), options, &curbed_gradient);
  }
  double plain = 0.0;
  double curbed = 0.0;
  Eigen::VectorXd gradient;
  Eigen::VectorXd curbed_gradient;
};

/// nlml_curb, and nlml_plain and the norm of the gradient where the case has them, at `loghyp`.
void compareOptimum(Case* reference, const GpData& data, const Hyperparameters& optimum) {
  const int outputs = static_cast<int>(data.targets.cols());
  Eigen::VectorXd plain(outputs), curbed(outputs), norm(outputs);
  for (int a = 0; a < outputs; ++a) {
    const Likelihood likelihood(data, a, thetaOf(optimum, a));
    plain[a] = likelihood.plain;
    curbed[a] = likelihood.curbed;
    norm[a] = likelihood.curbed_gradient.norm();
  }
  reference->compareVector("nlml_curb", curbed, relative(1e-9));
  reference->compareVector("nlml_plain", plain, relative(1e-9));
  reference->compareVector("final_gradient_norm_curb", norm, absolute(1e-7));
}

}  // namespace

void checkLikelihood(Case* reference) {
  GpData data;
  data.inputs = reference->matrix("X").transpose();
  data.targets = reference->vector("y", data.inputs.cols());
  const Eigen::Index dim = data.inputs.rows();
  reference->requireCount("D", dim);
  reference->requireCount("n", data.inputs.cols());
  const GpTrainingOptions options;
  reference->compareNumber("curb_ls", options.length_scale_limit, absolute(1e-12));
  reference->compareNumber("curb_snr", options.signal_to_noise_limit, absolute(1e-12));
  reference->requireCount("curb_power", options.curb_power);
  reference->compareVector("curb_std", sampleStd(data.inputs), relative(1e-12));

  const Likelihood likelihood(data, 0, reference->vector("loghyp", dim + 2));
  reference->compareNumber("nlml", likelihood.plain, relative(1e-9));
  reference->compareVector("dnlml", likelihood.gradient, relative(1e-7));
  reference->compareNumber("nlml_curb", likelihood.curbed, relative(1e-9));
  reference->compareVector("dnlml_curb", likelihood.curbed_gradient, relative(1e-7));
}

void checkTraining(Case* reference) {
  const GpData data = readGpData(reference);
  reference->requireCount("D", data.inputs.rows());
  reference->requireCount("E", data.targets.cols());
  reference->requireCount("n", data.inputs.cols());
  const GpTrainingOptions options;
  reference->requireCount("max_linesearches", options.max_iterations);
  if (reference->count("fn_evals_total") < 1) {  // of another optimiser: nothing to compare with
    reference->fail("fn_evals_total", "must be >= 1");
  }
  const Hyperparameters start = readHyperparameters(reference, "loghyp_init", data);
  reference->compareMatrix(
      "loghyp_init", toMatrix(initialHyperparameters(data.inputs, data.targets)), absolute(1e-9));
  const Hyperparameters optimum = readHyperparameters(reference, "loghyp", data);
  compareOptimum(reference, data, optimum);

  const GpFit fit = trainGp(data.inputs, data.targets, options, &start);
  usable(fit, *reference);
  Eigen::VectorXd cost(data.targets.cols());
  for (Eigen::Index a = 0; a < cost.size(); ++a) cost[a] = fit.outputs[a].final_cost;
  reference->compareVector("nlml_curb", cost, absolute(1e-4));
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
