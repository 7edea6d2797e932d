// One case of a file of reference values: its fields, and their comparison with what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ddm_pilco/gp_model.h"

namespace ddm::pilco::check {

/// How far a computed quantity may be from that of the file.
struct Tolerance {
  double limit;
  bool relative;  ///< to the largest entry of the field; otherwise absolute
};
constexpr Tolerance absolute(double limit) { return {limit, false}; }
constexpr Tolerance relative(double limit) { return {limit, true}; }

/// What became of all cases of one kind.
struct KindResult {
  int cases = 0;
  double worst_share = -1.0;  ///< largest error / tolerance; < 0: nothing compared
  double worst_error = 0.0;   ///< there
  double tolerance = 0.0;     ///< there
  std::string worst_place;    ///< there: case and field
  std::vector<std::string> problems;
};

/// Reads the fields of a case and compares them. A field of a group has the name GROUP/FIELD. All
/// functions throw std::invalid_argument that names the field where it is missing, of another shape
/// or not a number. A tolerance that is exceeded is not an error: it goes into the result.
class Case {
 public:
  static constexpr Eigen::Index kAny = -1;  ///< where any size will do

  /// @param result  of its kind; outlives this
  Case(const YAML::Node& node, const std::string& id, KindResult* result);

  bool has(const std::string& field) const { return fields_.count(field) > 0; }

  std::string text(const std::string& field);
  double number(const std::string& field) { return matrix(field, 1, 1)(0, 0); }
  int count(const std::string& field);
  /// A number, a column as a list of numbers, or a list of rows.
  Eigen::MatrixXd matrix(const std::string& field, Eigen::Index rows = kAny,
                         Eigen::Index cols = kAny);
  Eigen::VectorXd vector(const std::string& field, Eigen::Index size = kAny) {
    return matrix(field, size, 1);
  }
  Gaussian gaussian(const std::string& mean_field, const std::string& covariance_field,
                    Eigen::Index dim = kAny);

  /// A count that the other fields determine.
  void requireCount(const std::string& field, Eigen::Index expected);

  /// Compares a number, a vector or a matrix with the field.
  void compare(const std::string& field, const Eigen::MatrixXd& computed, Tolerance tolerance);
  void compare(const std::string& field, double computed, Tolerance tolerance);
  /// For what is not in the file as it is computed.
  void compareRead(const std::string& field, const Eigen::MatrixXd& from_file,
                   const Eigen::MatrixXd& computed, Tolerance tolerance);

  /// Fields that nothing looked at are errors: they would pass unchecked.
  void requireAllRead() const;

  static void require(bool ok, const std::string& field, const std::string& why);

 private:
  void add(const YAML::Node& node, const std::string& prefix);
  YAML::Node find(const std::string& field);

  std::string id_;
  std::map<std::string, YAML::Node> fields_;
  std::set<std::string> read_;
  KindResult* result_;
};

}  // namespace ddm::pilco::check
