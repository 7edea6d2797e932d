// One case of a file of reference values: its fields, and their comparison with what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/case.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

namespace ddm {
namespace pilco {
namespace check {
namespace {

std::string shapeText(Eigen::Index rows, Eigen::Index cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

std::string describe(double error, double limit, double from_file, double computed) {
  std::ostringstream text;
  text.precision(12);
  text << "the file has " << from_file << ", computed " << computed;
  text.precision(2);
  text << " (error " << std::scientific << error << ", tolerance " << limit << ")";
  return text.str();
}

/// The largest error of all entries, and where it is. One that is not finite is the largest.
double worstError(const Eigen::MatrixXd& from_file, const Eigen::MatrixXd& computed, bool relative,
                  Eigen::Index* row, Eigen::Index* col) {
  const double largest = from_file.cwiseAbs().maxCoeff();
  const double scale = relative && largest > 0.0 ? largest : 1.0;
  double worst = -1.0;
  for (Eigen::Index j = 0; j < computed.cols(); ++j) {
    for (Eigen::Index i = 0; i < computed.rows(); ++i) {
      double error = std::abs(computed(i, j) - from_file(i, j)) / scale;
      if (!std::isfinite(error)) error = std::numeric_limits<double>::infinity();
      if (error <= worst) continue;
      worst = error;
      *row = i;
      *col = j;
    }
  }
  return worst;
}

}  // namespace

Case::Case(const YAML::Node& node, const std::string& name, KindResult* result)
    : node_(node), id_(name), result_(result) {
  if (!node.IsMap()) throw CaseError("case " + name + ": must be an object with named fields");
  std::string twice;
  for (const auto& item : node) {
    const std::string field = item.first.as<std::string>();
    if (field == "id" && item.second.IsScalar()) id_ = item.second.as<std::string>();
    if (!fields_.insert(field).second) twice = field;
  }
  read_.insert("id");
  if (!twice.empty()) fail(twice, "is there twice");
}

void Case::fail(const std::string& field, const std::string& why) const {
  throw CaseError("case " + id_ + ", field " + field + ": " + why);
}

bool Case::has(const std::string& field) const { return fields_.count(field) > 0; }

bool Case::hasGroup(const std::vector<std::string>& fields) {
  const auto present = [this](const std::string& field) { return has(field); };
  if (std::none_of(fields.begin(), fields.end(), present)) return false;
  for (const std::string& field : fields) find(field);
  return true;
}

YAML::Node Case::find(const std::string& field) {
  if (!has(field)) fail(field, "is missing");
  read_.insert(field);
  return node_[field];
}

double Case::toNumber(const YAML::Node& node, const std::string& field) const {
  if (!node.IsScalar()) fail(field, "must be a number, got a list or nothing");
  const std::string& text = node.Scalar();
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || node.Tag() == "!") {
    fail(field, "must be a number, got '" + text + "'");
  }
  if (!std::isfinite(value)) fail(field, "must be a finite number, got " + text);
  return value;
}

Eigen::VectorXd Case::toVector(const YAML::Node& node, const std::string& field) const {
  if (!node.IsSequence()) fail(field, "must be a list of numbers");
  Eigen::VectorXd out(static_cast<Eigen::Index>(node.size()));
  Eigen::Index i = 0;
  for (const YAML::Node& entry : node) out[i++] = toNumber(entry, field);
  return out;
}

double Case::number(const std::string& field) { return toNumber(find(field), field); }

int Case::count(const std::string& field) {
  const double value = number(field);
  if (value < 0.0 || value > 1e6 || value != std::floor(value)) {
    fail(field, "must be a whole number, got " + find(field).Scalar());
  }
  return static_cast<int>(value);
}

std::string Case::text(const std::string& field) {
  const YAML::Node node = find(field);
  if (!node.IsScalar()) fail(field, "must be a text");
  return node.Scalar();
}

bool Case::flag(const std::string& field) {
  const std::string value = text(field);
  if (value != "true" && value != "false") fail(field, "must be true or false, got " + value);
  return value == "true";
}

Eigen::VectorXd Case::vector(const std::string& field) { return toVector(find(field), field); }

Eigen::VectorXd Case::vector(const std::string& field, Eigen::Index size) {
  const Eigen::VectorXd out = vector(field);
  if (out.size() != size) {
    fail(field,
         "must have " + std::to_string(size) + " entries, got " + std::to_string(out.size()));
  }
  return out;
}

Eigen::MatrixXd Case::matrix(const std::string& field) {
  const YAML::Node node = find(field);
  if (!node.IsSequence() || node.size() == 0) fail(field, "must be a list of rows");
  Eigen::MatrixXd out;
  Eigen::Index i = 0;
  for (const YAML::Node& row_node : node) {
    const Eigen::VectorXd row = toVector(row_node, field);
    if (i == 0) out.resize(static_cast<Eigen::Index>(node.size()), row.size());
    if (row.size() != out.cols()) fail(field, "has rows of different lengths");
    out.row(i++) = row.transpose();
  }
  if (out.cols() == 0) fail(field, "has rows without entries");
  return out;
}

Eigen::MatrixXd Case::matrix(const std::string& field, Eigen::Index rows, Eigen::Index cols) {
  const Eigen::MatrixXd out = matrix(field);
  if (out.rows() != rows || out.cols() != cols) {
    fail(field, "must be " + shapeText(rows, cols) + ", got " + shapeText(out.rows(), out.cols()));
  }
  return out;
}

Eigen::MatrixXd Case::covariance(const std::string& field, Eigen::Index dim) {
  const Eigen::MatrixXd out = matrix(field, dim, dim);
  const double asymmetry = (out - out.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > 1e-12 * out.cwiseAbs().maxCoeff()) fail(field, "must be symmetric");
  return out;
}

Case Case::group(const std::string& field) {
  const YAML::Node node = find(field);
  if (!node.IsMap()) fail(field, "must be an object with named fields");
  Case out(node, "", result_);
  out.id_ = id_ + "/" + field;
  return out;
}

void Case::requireCount(const std::string& field, Eigen::Index expected) {
  const int value = count(field);
  if (value != expected) {
    fail(field, "must be " + std::to_string(expected) + ", got " + std::to_string(value));
  }
}

void Case::compareNumber(const std::string& field, double computed, const Tolerance& tolerance) {
  compare(field, Eigen::MatrixXd::Constant(1, 1, number(field)),
          Eigen::MatrixXd::Constant(1, 1, computed), tolerance);
}

void Case::compareVector(const std::string& field, const Eigen::VectorXd& computed,
                         const Tolerance& tolerance) {
  compare(field, vector(field, computed.size()), computed, tolerance);
}

void Case::compareMatrix(const std::string& field, const Eigen::MatrixXd& computed,
                         const Tolerance& tolerance) {
  compare(field, matrix(field, computed.rows(), computed.cols()), computed, tolerance);
}

void Case::compare(const std::string& field, const Eigen::MatrixXd& from_file,
                   const Eigen::MatrixXd& computed, const Tolerance& tolerance) {
  if (computed.rows() != from_file.rows() || computed.cols() != from_file.cols()) {
    fail(field, "is " + shapeText(from_file.rows(), from_file.cols()) + ", computed " +
                    shapeText(computed.rows(), computed.cols()));
  }
  Eigen::Index row = 0, col = 0;
  const double worst = worstError(from_file, computed, tolerance.relative, &row, &col);
  if (worst / tolerance.limit > result_->worst_share) {
    result_->worst_share = worst / tolerance.limit;
    result_->worst_error = worst;
    result_->tolerance = tolerance.limit;
    result_->worst_place = id_ + ", " + field;
  }
  if (worst <= tolerance.limit) return;
  result_->problems.push_back(
      "case " + id_ + ", field " + field + ", entry (" + std::to_string(row + 1) + ", " +
      std::to_string(col + 1) +
      "): " + describe(worst, tolerance.limit, from_file(row, col), computed(row, col)));
}

void Case::report(const std::string& what, const Eigen::MatrixXd& from_file,
                  const Eigen::MatrixXd& computed) {
  Eigen::Index row = 0, col = 0;
  const double error = worstError(from_file, computed, true, &row, &col);
  double& worst = result_->reported[what];
  worst = std::max(worst, error);
}

void Case::requireAllRead() const {
  for (const std::string& field : fields_) {
    if (read_.count(field) == 0) fail(field, "is unknown, nothing compares it");
  }
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
