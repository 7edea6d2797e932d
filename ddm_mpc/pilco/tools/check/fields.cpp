// pilco_check: what cases of several kinds consist of, in the project's layout.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/fields.h"

#include "ddm_pilco/moments.h"

namespace ddm::pilco::check {
namespace {

/// Columns (p, q) and (q, p) by their mean. Only their sum has a meaning: a covariance is
/// symmetric, and how the derivative is divided between the two is an accident of the formula.
Eigen::MatrixXd symmetrized(const Eigen::MatrixXd& d_covariance, Eigen::Index dim) {
  Eigen::MatrixXd out(d_covariance.rows(), d_covariance.cols());
  for (Eigen::Index p = 0; p < dim; ++p) {
    for (Eigen::Index q = 0; q < dim; ++q) {
      out.col(q * dim + p) = 0.5 * (d_covariance.col(q * dim + p) + d_covariance.col(p * dim + q));
    }
  }
  return out;
}

}  // namespace

void compareMoments(Case* reference, const MomentFields& fields, const Moments& computed) {
  reference->compare(fields.at(0).name, computed.mean, fields[0].tolerance);
  reference->compare(fields.at(1).name, computed.covariance, fields[1].tolerance);
  reference->compare(fields.at(2).name, computed.gain, fields[2].tolerance);
}

void compareJacobians(Case* reference, const MomentFields& fields, const std::string& covariance,
                      int dim, int output_dim,
                      const std::function<Gaussian(const Moments&)>& backward) {
  if (!reference->has("d" + fields.front().name + "dm")) return;
  Moments seed = constantMoments(dim, output_dim);
  const std::vector<Eigen::Map<Eigen::VectorXd>> arrays = {
      {seed.mean.data(), seed.mean.size()},
      {seed.covariance.data(), seed.covariance.size()},
      {seed.gain.data(), seed.gain.size()}};
  for (std::size_t k = 0; k < fields.size(); ++k) {
    Eigen::Map<Eigen::VectorXd> array = arrays[k];
    Eigen::MatrixXd in_mean(array.size(), dim), in_covariance(array.size(), dim * dim);
    for (Eigen::Index i = 0; i < array.size(); ++i) {
      array[i] = 1.0;
      const Gaussian d_input = backward(seed);
      array[i] = 0.0;
      in_mean.row(i) = d_input.mean.transpose();
      in_covariance.row(i) =
          Eigen::Map<const Eigen::RowVectorXd>(d_input.covariance.data(), dim * dim);
    }
    const std::string derivative = "d" + fields[k].name + "d";
    reference->compare(derivative + "m", in_mean, fields[k].tolerance);
    reference->compareRead(
        derivative + covariance,
        symmetrized(reference->matrix(derivative + covariance, array.size(), dim * dim), dim),
        in_covariance, fields[k].tolerance);
  }
}

GpData readGpData(Case* reference) {
  const Eigen::MatrixXd inputs = reference->matrix("X").transpose();
  return {inputs, reference->matrix("Y", inputs.cols())};
}

Hyperparameters readHyperparameters(Case* reference, const std::string& field, const GpData& data) {
  const Eigen::Index dim = data.inputs.rows();
  const Eigen::MatrixXd values = reference->matrix(field, dim + 2, data.targets.cols());
  return {values.topRows(dim), values.row(dim).transpose(), values.row(dim + 1).transpose()};
}

Eigen::MatrixXd toMatrix(const Hyperparameters& hyperparameters) {
  const Eigen::Index dim = hyperparameters.log_length_scales.rows();
  Eigen::MatrixXd out(dim + 2, hyperparameters.log_signal_std.size());
  out << hyperparameters.log_length_scales, hyperparameters.log_signal_std.transpose(),
      hyperparameters.log_noise_std.transpose();
  return out;
}

GpModel usable(const GpFit& fit) {
  Case::require(fit.ok, "loghyp", fit.message);
  return fit.model;
}

GpModel readModel(Case* reference, const GpData& data) {
  return usable(
      makeGpModel(data.inputs, data.targets, readHyperparameters(reference, "loghyp", data)));
}

GpFit trainFromStart(Case* reference, const GpData& data) {
  const Hyperparameters start = readHyperparameters(reference, "loghyp_init", data);
  reference->compare("loghyp_init", toMatrix(initialHyperparameters(data.inputs, data.targets)),
                     absolute(1e-9));
  const GpFit fit = trainGp(data.inputs, data.targets, GpTrainingOptions(), &start);
  usable(fit);
  return fit;
}

Eigen::VectorXd readParameters(Case* reference, int dim, int controls, const std::string& group) {
  const Eigen::MatrixXd centres = reference->matrix(group + "centres", Case::kAny, dim);
  return RbfPolicy::packParameters(reference->matrix(group + "log_ls", dim, controls),
                                   centres.transpose(),
                                   reference->matrix(group + "targets", centres.rows(), controls));
}

std::unique_ptr<RbfPolicy> readRbfPolicy(Case* reference, int dim, int controls) {
  const Eigen::VectorXd parameters = readParameters(reference, dim, controls);
  const auto num_centres = (parameters.size() - dim * controls) / (dim + controls);
  auto rbf = std::make_unique<RbfPolicy>(dim, controls, static_cast<int>(num_centres));
  rbf->setParameters(parameters);
  return rbf;
}

}  // namespace ddm::pilco::check
