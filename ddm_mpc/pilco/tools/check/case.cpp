// One case of a file of reference values: its fields, and their comparison with what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/case.h"

#include <ddm_params/parse_number.h>
#include <ddm_params/yaml_text.h>

#include <cmath>
#include <iomanip>
#include <limits>

#include "ddm_pilco/messages.h"
#include "ddm_pilco/moments.h"

namespace ddm::pilco::check {
namespace {

/// NaN, infinity and a quoted number are none.
double toNumber(const YAML::Node& node, const std::string& field) {
  double value = 0.0;
  const bool quoted = node.Tag() == "!";
  Case::require(node.IsScalar() && !quoted && parseNumber(node.Scalar(), &value), field,
                "must be a finite number, got " + oneLine(node));
  return value;
}

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

Case::Case(const YAML::Node& node, const std::string& id, KindResult* result)
    : id_(id), read_{"id"}, result_(result) {
  add(node, "");
}

void Case::add(const YAML::Node& node, const std::string& prefix) {
  for (const auto& item : node) {
    const std::string field = prefix + item.first.as<std::string>();
    if (item.second.IsMap()) {
      add(item.second, field + "/");
    } else {
      require(fields_.emplace(field, item.second).second, field, "is there twice");
    }
  }
}

void Case::require(bool ok, const std::string& field, const std::string& why) {
  pilco::require(ok, "field ", field, ": ", why);
}

YAML::Node Case::find(const std::string& field) {
  require(has(field), field, "is missing");
  read_.insert(field);
  return fields_.at(field);
}

std::string Case::text(const std::string& field) {
  const YAML::Node node = find(field);
  require(node.IsScalar(), field, "must be a text");
  return node.Scalar();
}

int Case::count(const std::string& field) {
  const double value = number(field);
  require(value >= 0.0 && value <= 1e6 && value == std::floor(value), field,
          message("must be a whole number, got ", value));
  return static_cast<int>(value);
}

Eigen::MatrixXd Case::matrix(const std::string& field, Eigen::Index rows, Eigen::Index cols) {
  const YAML::Node node = find(field);
  const bool one_number = !node.IsSequence();
  const std::size_t num_rows = one_number ? 1 : node.size();
  const bool column = one_number || num_rows == 0 || !node[0].IsSequence();
  Eigen::MatrixXd out(num_rows, column ? 1 : node[0].size());
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const YAML::Node row = one_number ? node : node[i];
    require(column || (row.IsSequence() && row.size() == node[0].size()), field,
            "has rows of different lengths");
    for (Eigen::Index j = 0; j < out.cols(); ++j)
      out(i, j) = toNumber(column ? row : row[j], field);
  }
  const bool fits = (rows == kAny || out.rows() == rows) && (cols == kAny || out.cols() == cols);
  require(fits && out.size() > 0, field,
          message("must be ", rows, " x ", cols, ", got ", out.rows(), " x ", out.cols()));
  return out;
}

Gaussian Case::gaussian(const std::string& mean_field, const std::string& covariance_field,
                        Eigen::Index dim) {
  const Eigen::VectorXd mean = vector(mean_field, dim);
  const Eigen::MatrixXd covariance = matrix(covariance_field, mean.size(), mean.size());
  require(covariance.isApprox(covariance.transpose()), covariance_field, "must be symmetric");
  return {mean, covariance};
}

void Case::requireCount(const std::string& field, Eigen::Index expected) {
  const int value = count(field);
  require(value == expected, field, message("must be ", expected, ", got ", value));
}

void Case::compare(const std::string& field, double computed, Tolerance tolerance) {
  compare(field, Eigen::MatrixXd::Constant(1, 1, computed), tolerance);
}

void Case::compare(const std::string& field, const Eigen::MatrixXd& computed, Tolerance tolerance) {
  compareRead(field, matrix(field, computed.rows(), computed.cols()), computed, tolerance);
}

void Case::compareRead(const std::string& field, const Eigen::MatrixXd& from_file,
                       const Eigen::MatrixXd& computed, Tolerance tolerance) {
  requireShape(from_file, computed.rows(), computed.cols(), "field " + field);
  const double largest = from_file.cwiseAbs().maxCoeff();
  const double scale = tolerance.relative && largest > 0.0 ? largest : 1.0;
  const Eigen::ArrayXXd errors = (computed - from_file).array().abs() / scale;
  Eigen::Index row = 0, col = 0;
  const double worst =  // one that is not finite is the largest
      errors.isFinite()
          .select(errors, std::numeric_limits<double>::infinity())
          .maxCoeff(&row, &col);
  if (worst / tolerance.limit > result_->worst_share) {
    result_->worst_share = worst / tolerance.limit;
    result_->worst_error = worst;
    result_->tolerance = tolerance.limit;
    result_->worst_place = id_ + ", " + field;
  }
  if (worst <= tolerance.limit) return;
  result_->problems.push_back(message("case ", id_, ", field ", field, ", entry (", row + 1, ", ",
                                      col + 1, "): the file has ", std::setprecision(12),
                                      from_file(row, col), ", computed ", computed(row, col),
                                      std::setprecision(2), std::scientific, " (error ", worst,
                                      ", tolerance ", tolerance.limit, ")"));
}

void Case::requireAllRead() const {
  for (const auto& field : fields_) {
    require(read_.count(field.first) > 0, field.first, "is unknown, nothing compares it");
  }
}

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
