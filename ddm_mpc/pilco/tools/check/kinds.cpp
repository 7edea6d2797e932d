// pilco_check: what is computed from the fields of each kind of cases, and how near it must come.
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <utility>
#include <vector>

#include "check/case.h"
#include "ddm_pilco/gp_moments.h"
#include "ddm_pilco/sparse_gp.h"
#include "ddm_pilco/state_cost.h"

namespace ddm::pilco::check {
namespace {

constexpr Tolerance kPolicy = absolute(1e-9);

const MomentFields kTrigonometric = {{"M", kClosedForm}, {"V", kClosedForm}, {"C", kClosedForm}};

GpData readSizedData(Case* reference) {
  const GpData data = readGpData(reference);
  reference->requireCount("D", data.inputs.rows());
  reference->requireCount("E", data.targets.cols());
  reference->requireCount("n", data.inputs.cols());
  return data;
}

void comparePrediction(Case* reference, const GpModel& model) {
  const MomentFields fields = {
      {"M", relative(1e-10)}, {"S", relative(1e-9)}, {"V", relative(1e-10)}};
  GpMoments moments(model);
  const int dim = model.inputDim();
  GpMoments::Tape tape;
  compareMoments(reference, fields, moments.predict(reference->gaussian("m", "s", dim), &tape));
  compareJacobians(reference, fields, "s", dim, model.outputDim(),
                   [&](const Moments& seed) { return moments.backward(tape, seed); });
}

void checkGpPredict(Case* reference) {
  const GpData data = readSizedData(reference);
  comparePrediction(reference, readModel(reference, data));
}

void checkSparseGpPredict(Case* reference) {
  const GpData data = readSizedData(reference);
  const Eigen::MatrixXd inducing = reference->matrix("Z").transpose();
  reference->requireCount("np", inducing.cols());
  comparePrediction(reference,
                    usable(makeSparseGpModel(inducing, data.inputs, data.targets,
                                             readHyperparameters(reference, "loghyp", data),
                                             reference->number("ridge"))));
}

/// What training minimises for one output.
double curbedLikelihood(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& targets,
                        const Eigen::VectorXd& theta, Eigen::VectorXd* gradient) {
  const double plain = negativeLogLikelihood(inputs, targets, theta, gradient);
  return plain + curb(theta, sampleStd(inputs), GpTrainingOptions(), gradient);
}

void checkLikelihood(Case* reference) {
  const Eigen::MatrixXd inputs = reference->matrix("X").transpose();
  reference->requireCount("D", inputs.rows());
  reference->requireCount("n", inputs.cols());
  const GpTrainingOptions options;
  reference->compare("curb_ls", options.length_scale_limit, kClosedForm);
  reference->compare("curb_snr", options.signal_to_noise_limit, kClosedForm);
  reference->requireCount("curb_power", options.curb_power);
  reference->compare("curb_std", sampleStd(inputs), relative(1e-12));

  const Eigen::VectorXd targets = reference->vector("y", inputs.cols());
  const Eigen::VectorXd theta = reference->vector("loghyp", inputs.rows() + 2);
  Eigen::VectorXd gradient;
  reference->compare("nlml", negativeLogLikelihood(inputs, targets, theta, &gradient),
                     relative(1e-9));
  reference->compare("dnlml", gradient, relative(1e-7));
  reference->compare("nlml_curb", curbedLikelihood(inputs, targets, theta, &gradient),
                     relative(1e-9));
  reference->compare("dnlml_curb", gradient, relative(1e-7));
}

void checkTraining(Case* reference) {
  const GpData data = readSizedData(reference);
  reference->requireCount("max_linesearches", GpTrainingOptions().max_iterations);
  reference->count("fn_evals_total");  // of another optimiser: nothing to compare with
  const Hyperparameters optimum = readHyperparameters(reference, "loghyp", data);
  const GpFit fit = trainFromStart(reference, data);

  const int outputs = static_cast<int>(data.targets.cols());
  Eigen::VectorXd plain(outputs), curbed(outputs), norm(outputs), trained(outputs);
  for (int a = 0; a < outputs; ++a) {
    const Eigen::VectorXd theta = thetaOf(optimum, a);
    Eigen::VectorXd gradient;
    plain[a] = negativeLogLikelihood(data.inputs, data.targets.col(a), theta);
    curbed[a] = curbedLikelihood(data.inputs, data.targets.col(a), theta, &gradient);
    norm[a] = gradient.norm();
    trained[a] = fit.outputs[a].cost;
  }
  reference->compare("nlml_curb", curbed, relative(1e-9));
  reference->compare("nlml_plain", plain, relative(1e-9));
  reference->compare("final_gradient_norm_curb", norm, absolute(1e-7));
  reference->compare("nlml_curb", trained, absolute(1e-4));
}

/// The field index1, from 0.
std::vector<int> readIndices(Case* reference) {
  std::vector<int> out;
  const Eigen::VectorXd entries = reference->vector("index1");
  for (Eigen::Index i = 0; i < entries.size(); ++i) {
    out.push_back(static_cast<int>(entries[i]) - 1);
  }
  return out;
}

/// A matrix that picks these entries of a vector.
Eigen::MatrixXd picking(const std::vector<int>& indices, Eigen::Index size) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(indices.size(), size);
  for (std::size_t i = 0; i < indices.size(); ++i) out(i, indices[i]) = 1.0;
  return out;
}

/// Sines and cosines of the entries index1, times the scales e.
Augmentation readAugmentation(Case* reference, int dim) {
  const std::vector<int> angles = readIndices(reference);
  const Eigen::VectorXd scales = reference->vector("e", static_cast<Eigen::Index>(angles.size()));
  return Augmentation(dim, {}, angles, {scales.data(), scales.data() + scales.size()});
}

void checkTrigonometric(Case* reference) {
  const Gaussian input = reference->gaussian("m", "v");
  const int dim = static_cast<int>(input.mean.size());
  const Augmentation augmentation = readAugmentation(reference, dim);
  const Moments computed = augmentation.predict(input);
  compareMoments(reference, kTrigonometric, computed);
  reference->compare("cov_in_out", input.covariance * computed.gain, kClosedForm);
  compareJacobians(reference, kTrigonometric, "v", dim, augmentation.outputDim(),
                   [&](const Moments& seed) { return augmentation.backward(input, seed); });
}

/// The sines alone: every other output of the augmentation.
void checkSine(Case* reference) {
  const Gaussian input = reference->gaussian("m", "v");
  const Moments all =
      readAugmentation(reference, static_cast<int>(input.mean.size())).predict(input);
  std::vector<int> sines;
  for (int i = 0; i < all.mean.size(); i += 2) sines.push_back(i);
  const Eigen::MatrixXd pick = picking(sines, all.mean.size());
  compareMoments(reference, kTrigonometric,
                 Moments{pick * all.mean, pick * all.covariance * pick.transpose(),
                         all.gain * pick.transpose()});
}

void checkSquashing(Case* reference) {
  const Gaussian input = reference->gaussian("m", "v");
  const int dim = static_cast<int>(input.mean.size());
  const std::vector<int> indices = readIndices(reference);
  const int count = static_cast<int>(indices.size());
  for (const int index : indices) {
    Case::require(index >= 0 && index < dim, "index1", "is not an index");
  }
  const Eigen::MatrixXd pick = picking(indices, dim);  // what is squashed
  const Squashing squashing(reference->vector("maxU", count));
  const Gaussian chosen = {pick * input.mean, pick * input.covariance * pick.transpose()};

  Moments computed = squashing.predict(chosen);
  computed.gain = pick.transpose() * computed.gain;
  compareMoments(reference, kTrigonometric, computed);
  compareJacobians(reference, kTrigonometric, "v", dim, count, [&](const Moments& seed) {
    const Gaussian d_chosen =
        squashing.backward(chosen, Moments{seed.mean, seed.covariance, pick * seed.gain});
    return Gaussian{pick.transpose() * d_chosen.mean,
                    pick.transpose() * d_chosen.covariance * pick};
  });
}

/// Gradients of squashed mean and variance in the parameters of an RBF policy with one control,
/// where the file has them.
void compareGradients(Case* reference, SquashedPolicy* policy, const Gaussian& input) {
  if (!reference->has("dM_sq_dlog_ls")) return;
  Case::require(policy->outputDim() == 1, "dM_sq_dlog_ls", "is known for one control only");
  const Eigen::Index dim = policy->inputDim();
  const Eigen::Index num_centres = (policy->numParameters() - dim) / (dim + 1);
  for (const std::string name : {"dM_sq", "dS_sq"}) {
    Moments seed = constantMoments(policy->inputDim(), 1);
    (name == "dM_sq" ? seed.mean[0] : seed.covariance(0, 0)) = 1.0;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(policy->numParameters());
    policy->backward(input, seed, &gradient);
    const Eigen::Map<const Eigen::MatrixXd> centres(gradient.data() + dim, num_centres, dim);
    reference->compare(name + "_dlog_ls", gradient.head(dim), kPolicy);
    reference->compare(name + "_dcentres", centres, kPolicy);
    reference->compare(name + "_dtargets", gradient.tail(num_centres), kPolicy);
  }
}

void checkPolicy(Case* reference) {
  const int dim = reference->count("D");
  const int controls = reference->count("U");
  const Gaussian input = reference->gaussian("m", "s", dim);
  const Eigen::VectorXd max_control = reference->vector("maxU", controls);
  const std::string kind = reference->text("kind");
  Moments plain, squashed;
  if (kind == "conlin") {  // no policy of the library, but easily squashed
    const Eigen::MatrixXd w = reference->matrix("w", controls, dim);
    plain = {w * input.mean + reference->vector("b", controls),
             w * input.covariance * w.transpose(), w.transpose()};
    squashed = Squashing(max_control).applyTo(plain);
  } else {
    Case::require(kind == "congp", "kind", "must be congp or conlin, got " + kind);
    std::unique_ptr<RbfPolicy> rbf = readRbfPolicy(reference, dim, controls);
    reference->requireCount("nc", reference->matrix("centres").rows());
    plain = rbf->predict(input);
    SquashedPolicy policy(std::move(rbf), max_control);
    squashed = policy.predict(input);
    compareGradients(reference, &policy, input);
  }
  compareMoments(reference, {{"M", kPolicy}, {"S", kPolicy}, {"C", kPolicy}}, plain);
  compareMoments(reference, {{"M_sq", kPolicy}, {"S_sq", kPolicy}, {"C_sq", kPolicy}}, squashed);
}

template <class Cost>
void compareCost(Case* reference, const Cost& cost) {
  const int dim = cost.inputDim();
  const Gaussian input = reference->gaussian("m", "s", dim);
  Gaussian d_input;
  reference->compare("L", cost.expected(input, &d_input), kClosedForm);
  reference->compare("var", cost.variance(input), kClosedForm);
  reference->compare("dLdm", d_input.mean, kClosedForm);
  reference->compareRead("dLds", symmetricPart(reference->matrix("dLds", dim, dim)),
                         d_input.covariance, kClosedForm);
}

void checkSaturatingCost(Case* reference) {
  const Eigen::VectorXd target = reference->vector("z");
  reference->requireCount("D", target.size());
  compareCost(reference,
              SaturatingCost(target, reference->matrix("W", target.size(), target.size())));
}

void checkPendulumCost(Case* reference) {
  reference->compare("target", Eigen::Vector2d(0.0, M_PI), kClosedForm);
  compareCost(reference, pendulumCost(reference->number("length"), reference->number("width")));
}

}  // namespace

const std::map<std::string, Check>& kinds() {
  static const std::map<std::string, Check> all = {{"gp_predict", checkGpPredict},
                                                   {"gp_predict_fitc", checkSparseGpPredict},
                                                   {"gp_nlml", checkLikelihood},
                                                   {"train", checkTraining},
                                                   {"gtrig", checkTrigonometric},
                                                   {"gsin", checkSine},
                                                   {"gsat", checkSquashing},
                                                   {"policy", checkPolicy},
                                                   {"loss_sat", checkSaturatingCost},
                                                   {"loss_pendulum", checkPendulumCost},
                                                   {"simulate", checkSimulation},
                                                   {"propagate", checkPropagation},
                                                   {"value", checkValue},
                                                   {"authors", checkAuthors}};
  return all;
}

}  // namespace ddm::pilco::check
