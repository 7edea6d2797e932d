// One case of a file of reference values: its fields, and their comparison with what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/case.h"

#include <ddm_params/number_csv.h>
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

}  // namespace ddm::pilco::check
