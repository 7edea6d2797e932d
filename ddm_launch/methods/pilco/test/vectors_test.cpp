// Compares PILCO with the reference values in the JSON file that DDM_PILCO_VECTORS names.
// SPDX-License-Identifier: BSD-3-Clause
//
// A case fails if a field is missing or differs.
#include <ddm_model/minimise.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "pilco/long_term_cost.h"

namespace ddm::pilco {
namespace {

/// Largest difference between computed value and file: absolute, or in units of the largest entry
/// of the field.
struct Tolerance {
  double limit;
  bool relative;
};
constexpr Tolerance absolute(double limit) { return {limit, false}; }
constexpr Tolerance relative(double limit) { return {limit, true}; }
constexpr Tolerance kClosedForm = absolute(1e-12);
constexpr Tolerance kState = absolute(1e-9);

void expectNear(const std::string& field, const Eigen::MatrixXd& expected,
                const Eigen::MatrixXd& computed, Tolerance tolerance) {
  ASSERT_EQ(expected.rows(), computed.rows()) << field;
  ASSERT_EQ(expected.cols(), computed.cols()) << field;
  const double largest = expected.cwiseAbs().maxCoeff();
  const double scale = tolerance.relative && largest > 0.0 ? largest : 1.0;
  for (Eigen::Index i = 0; i < computed.size(); ++i) {
    // The condition is written such that NaN fails.
    EXPECT_TRUE(std::abs(computed(i) - expected(i)) <= tolerance.limit * scale)
        << field << ", entry " << i << " by columns: the file has " << expected(i) << ", computed "
        << computed(i) << ", tolerance " << tolerance.limit * scale;
  }
}

/// One case of the file. All functions throw if a field is missing or not a number.
class Case {
 public:
  explicit Case(const YAML::Node& node) : node_(node) {}

  bool has(const std::string& field) const { return node_[field].IsDefined(); }
  std::string text(const std::string& field) const { return at(field).as<std::string>(); }
  double number(const std::string& field) const { return at(field).as<double>(); }
  Case group(const std::string& field) const { return Case(at(field)); }

  /// Reads a number, a column as a list of numbers, or a matrix as a list of rows.
  Eigen::MatrixXd matrix(const std::string& field) const {
    const YAML::Node node = at(field);
    if (node.IsScalar()) return Eigen::MatrixXd::Constant(1, 1, node.as<double>());
    const bool column = node[0].IsScalar();
    Eigen::MatrixXd out(node.size(), column ? 1 : node[0].size());
    for (Eigen::Index i = 0; i < out.rows(); ++i) {
      const YAML::Node row = node[i];
      if (!column && row.size() != node[0].size())
        throw std::runtime_error(field + ": rows differ");
      for (Eigen::Index j = 0; j < out.cols(); ++j) {
        out(i, j) = (column ? row : row[j]).as<double>();
      }
    }
    return out;
  }
  Eigen::VectorXd vector(const std::string& field) const {
    const Eigen::MatrixXd column = matrix(field);
    if (column.cols() != 1) throw std::runtime_error(field + ": must be a list of numbers");
    return column;
  }
  Gaussian gaussian(const std::string& mean, const std::string& covariance) const {
    return {vector(mean), matrix(covariance)};
  }

  void compare(const std::string& field, const Eigen::MatrixXd& computed,
               Tolerance tolerance) const {
    expectNear(field, matrix(field), computed, tolerance);
  }
  void compare(const std::string& field, double computed, Tolerance tolerance) const {
    compare(field, Eigen::MatrixXd::Constant(1, 1, computed), tolerance);
  }

 private:
  YAML::Node at(const std::string& field) const {
    if (!has(field)) throw std::runtime_error("field " + field + " is missing");
    return node_[field];
  }

  YAML::Node node_;
};

/// Names of mean, covariance and gain of an output in the file, in this order, with their
/// tolerances.
using MomentFields = std::vector<std::pair<std::string, Tolerance>>;
const MomentFields kPolicy = {{"M", kState}, {"S", kState}, {"C", kState}};
const MomentFields kSquashed = {{"M_sq", kState}, {"S_sq", kState}, {"C_sq", kState}};

void compareMoments(const Case& reference, const MomentFields& fields, const Moments& computed) {
  reference.compare(fields[0].first, computed.mean, fields[0].second);
  reference.compare(fields[1].first, computed.covariance, fields[1].second);
  reference.compare(fields[2].first, computed.gain, fields[2].second);
}

GpModel usable(const GpFit& fit) {
  if (!fit.ok()) throw std::runtime_error("the GP cannot be used: " + fit.message);
  return fit.model;
}

GpModel readModel(const Case& reference) {
  return usable(makeGpModel(reference.matrix("X").transpose(), reference.matrix("Y"),
                            reference.matrix("loghyp")));
}

void comparePrediction(const Case& reference, const GpModel& model) {
  const MomentFields fields = {
      {"M", relative(1e-10)}, {"S", relative(1e-9)}, {"V", relative(1e-10)}};
  compareMoments(reference, fields, GpMoments(model).predict(reference.gaussian("m", "s")));
}

void checkGpPredict(const Case& reference) { comparePrediction(reference, readModel(reference)); }

void checkSparseGpPredict(const Case& reference) {
  reference.compare("ridge", kRidge, kClosedForm);
  comparePrediction(
      reference,
      usable(makeSparseGpModel(reference.matrix("Z").transpose(), reference.matrix("X").transpose(),
                               reference.matrix("Y"), reference.matrix("loghyp"))));
}

/// The objective of the training for one output.
double objective(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& targets,
                 const Eigen::VectorXd& theta, Eigen::VectorXd* gradient) {
  const double plain = negativeLogLikelihood(inputs, targets, theta, gradient);
  return plain + penalty(theta, sampleStd(inputs), gradient);
}

void checkLikelihood(const Case& reference) {
  const Eigen::MatrixXd inputs = reference.matrix("X").transpose();
  reference.compare("curb_ls", kLengthScaleLimit, kClosedForm);
  reference.compare("curb_snr", kSignalToNoiseLimit, kClosedForm);
  reference.compare("curb_power", kPenaltyPower, kClosedForm);
  reference.compare("curb_std", sampleStd(inputs), relative(1e-12));
  const Eigen::VectorXd targets = reference.vector("y");
  const Eigen::VectorXd theta = reference.vector("loghyp");
  Eigen::VectorXd gradient;
  reference.compare("nlml", negativeLogLikelihood(inputs, targets, theta, &gradient),
                    relative(1e-9));
  reference.compare("dnlml", gradient, relative(1e-7));
  reference.compare("nlml_curb", objective(inputs, targets, theta, &gradient), relative(1e-9));
  reference.compare("dnlml_curb", gradient, relative(1e-7));
}

/// Compares the field loghyp_init with the initial hyper-parameters, and trains from there.
GpFit trainFromStart(const Case& reference) {
  const Eigen::MatrixXd inputs = reference.matrix("X").transpose(), targets = reference.matrix("Y");
  const Hyperparameters start = reference.matrix("loghyp_init");
  reference.compare("loghyp_init", initialHyperparameters(inputs, targets), absolute(1e-9));
  GpFit fit = trainGp(inputs, targets, PilcoOptions().hyperparameter_iterations, start);
  usable(fit);
  return fit;
}

void checkTraining(const Case& reference) {
  const Eigen::MatrixXd inputs = reference.matrix("X").transpose(), targets = reference.matrix("Y");
  const Hyperparameters optimum = reference.matrix("loghyp");
  const GpFit fit = trainFromStart(reference);
  const int outputs = static_cast<int>(targets.cols());
  Eigen::VectorXd plain(outputs), penalised(outputs), norm(outputs), trained(outputs);
  for (int a = 0; a < outputs; ++a) {
    const Eigen::VectorXd theta = optimum.col(a);
    Eigen::VectorXd gradient;
    plain[a] = negativeLogLikelihood(inputs, targets.col(a), theta);
    penalised[a] = objective(inputs, targets.col(a), theta, &gradient);
    norm[a] = gradient.norm();
    trained[a] = fit.outputs[a].cost;
  }
  reference.compare("nlml_curb", penalised, relative(1e-9));
  reference.compare("nlml_plain", plain, relative(1e-9));
  reference.compare("final_gradient_norm_curb", norm, absolute(1e-7));
  reference.compare("nlml_curb", trained, absolute(1e-4));
}

/// Reads the parameters of an RBF policy from their parts.
Eigen::VectorXd readParameters(const Case& reference) {
  return RbfPolicy::packParameters(reference.matrix("log_ls"),
                                   reference.matrix("centres").transpose(),
                                   reference.matrix("targets"));
}

RbfPolicy readPolicy(const Case& reference) {
  const Eigen::MatrixXd centres = reference.matrix("centres");
  RbfPolicy policy(static_cast<int>(centres.cols()), static_cast<int>(centres.rows()),
                   reference.vector("maxU"));
  policy.setParameters(readParameters(reference));
  return policy;
}

void checkPolicy(const Case& reference) {
  const Gaussian input = reference.gaussian("m", "s");
  if (reference.text("kind") == "conlin") return;  // linear policies are not in the library
  ASSERT_EQ(reference.text("kind"), "congp");
  const RbfPolicy policy = readPolicy(reference);
  compareMoments(reference, kPolicy, policy.predictUnsquashed(input));
  compareMoments(reference, kSquashed, policy.predict(input));
}

/// Whether the policy sees measurement noise (see Propagation) in this published version of the
/// pendulum scenario.
bool hasNoisyPolicyInput(const Case& reference) {
  const std::string name = reference.text("scenario");
  if (name == "a0b48b7") return false;
  if (name == "f9707a9") return true;
  throw std::runtime_error("unknown scenario " + name);
}

Propagation readPropagation(const Case& reference) {
  return Propagation(readModel(reference), {1}, hasNoisyPolicyInput(reference));
}

void checkPropagation(const Case& reference) {
  const RbfPolicy policy = readPolicy(reference);
  const Propagation propagation = readPropagation(reference);
  const Gaussian next = propagation.step(policy, reference.gaussian("m", "s"));
  reference.compare("m_next", next.mean, kState);
  reference.compare("s_next", next.covariance, kState);
}

LongTermCost readLongTermCost(const Case& reference, RbfPolicy* policy) {
  reference.compare("target", Eigen::Vector2d(0.0, M_PI), kClosedForm);
  return LongTermCost(readPropagation(reference), pendulumCost(1.0, reference.number("width")),
                      policy, reference.gaussian("m0", "s0"),
                      static_cast<int>(reference.number("H")));
}

/// Compares means and covariances for t = 0 ... H.
void compareStates(const Case& reference, const std::vector<Gaussian>& states,
                   Tolerance tolerance) {
  Eigen::MatrixXd means(states.size(), 2), covariances(states.size(), 3);
  for (std::size_t t = 0; t < states.size(); ++t) {
    const Eigen::MatrixXd& s = states[t].covariance;
    means.row(t) = states[t].mean.transpose();
    covariances.row(t) << s(0, 0), s(1, 1), s(0, 1);
  }
  reference.compare("means_0_to_H", means, tolerance);
  reference.compare("var_dphi_0_to_H", covariances.col(0), tolerance);
  reference.compare("var_phi_0_to_H", covariances.col(1), tolerance);
  reference.compare("cov_dphi_phi_0_to_H", covariances.col(2), tolerance);
}

void checkValue(const Case& reference) {
  RbfPolicy policy = readPolicy(reference);
  LongTermCost cost = readLongTermCost(reference, &policy);
  Eigen::VectorXd exact;
  reference.compare("J", cost.evaluate(policy.parameters(), &exact), kState);
  reference.compare("cost_per_step_1_to_H",
                    Eigen::Map<const Eigen::VectorXd>(cost.costs().data(), cost.costs().size()),
                    kState);
  compareStates(reference, cost.states(), kState);
  // The published program neglects the measurement noise in its chain rule, so that its gradient is
  // wrong by up to 3e-4.
  const bool published_is_exact = !hasNoisyPolicyInput(reference);
  expectNear("grad_as_implemented", readParameters(reference.group("grad_as_implemented")), exact,
             relative(published_is_exact ? 1e-6 : 1e-3));
}

/// Checks a model and a policy of the authors' own experiment.
void checkAuthors(const Case& reference) {
  constexpr Tolerance kTolerance = relative(1e-5);
  const GpFit fit = trainFromStart(reference);
  reference.compare("loghyp", fit.model.hyperparameters, kTolerance);
  reference.compare("nlml_curb", Eigen::Vector2d(fit.outputs[0].cost, fit.outputs[1].cost),
                    kTolerance);
  RbfPolicy policy = readPolicy(reference);
  LongTermCost cost = readLongTermCost(reference, &policy);
  reference.compare("J", cost.evaluate(policy.parameters()), kTolerance);
  compareStates(reference, cost.states(), kTolerance);
  const StateCost per_step = pendulumCost(1.0, reference.number("width"));
  Eigen::MatrixXd costs(cost.states().size(), 2);
  for (std::size_t t = 0; t < cost.states().size(); ++t) {
    costs.row(t) << per_step.expected(cost.states()[t]),
        std::sqrt(per_step.variance(cost.states()[t]));
  }
  reference.compare("cost_per_step_0_to_H", costs.col(0), kTolerance);
  reference.compare("cost_std_per_step_0_to_H", costs.col(1), kTolerance);
}

/// The checks by their name in the file. Further kinds in the file are parts of these (moments of
/// sines and of the squashing, costs of one state), or tested in ddm_sim (steps of the pendulum).
const std::map<std::string, std::function<void(const Case&)>> kKinds = {
    {"gp_predict", checkGpPredict}, {"gp_predict_fitc", checkSparseGpPredict},
    {"gp_nlml", checkLikelihood},   {"train", checkTraining},
    {"policy", checkPolicy},        {"propagate", checkPropagation},
    {"value", checkValue},          {"authors", checkAuthors}};

/// Skipped if the environment names no file. A missing or damaged file is a failure.
class PilcoVectors : public ::testing::Test {
 protected:
  void SetUp() override {
    silenceSolverLog();
    const char* const path = std::getenv("DDM_PILCO_VECTORS");
    if (path == nullptr || *path == '\0') {
      GTEST_SKIP() << "DDM_PILCO_VECTORS names no file: nothing was compared";
    }
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    std::string json = text.str();
    std::replace(json.begin(), json.end(), '\t', ' ');  // JSON is a subset of YAML except for tabs
    ASSERT_NO_THROW(root_ = YAML::Load(json)) << path;
    ASSERT_TRUE(root_.IsMap()) << path << " must hold a JSON object with kinds of cases";
  }

  YAML::Node root_;
};

TEST_F(PilcoVectors, AgreeInEveryCaseOfEachKind) {
  for (const auto& [kind, check] : kKinds) {
    const YAML::Node cases = root_[kind];
    ASSERT_TRUE(cases.IsSequence() && cases.size() > 0) << kind;
    for (const YAML::Node& node : cases) {
      const Case reference(node);
      SCOPED_TRACE(kind + ", case " + (reference.has("id") ? reference.text("id") : "without id"));
      EXPECT_NO_THROW(check(reference));
    }
  }
}

}  // namespace
}  // namespace ddm::pilco
