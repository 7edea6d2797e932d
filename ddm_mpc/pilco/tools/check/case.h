// One case of a file of reference values: its fields, and their comparison with what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace ddm {
namespace pilco {
namespace check {

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
  /// Largest errors that are told and not judged, by what was compared.
  std::map<std::string, double> reported;
};

/// A field that is missing, of another shape, or not a number where there must be one.
class CaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads the fields of a case and compares them. All functions throw CaseError that names case and
/// field; an exceeded tolerance is no error, it goes into the result.
class Case {
 public:
  /// @param name    what the case is called in messages if it has no id
  /// @param result  of its kind; outlives this
  Case(const YAML::Node& node, const std::string& name, KindResult* result);

  const std::string& id() const { return id_; }
  bool has(const std::string& field) const;

  /// Whether all of these fields are there; false if none of them is.
  /// @throws CaseError that names a missing one if only some are there
  bool hasGroup(const std::vector<std::string>& fields);

  double number(const std::string& field);
  int count(const std::string& field);
  bool flag(const std::string& field);
  std::string text(const std::string& field);
  Eigen::VectorXd vector(const std::string& field);
  Eigen::VectorXd vector(const std::string& field, Eigen::Index size);
  Eigen::MatrixXd matrix(const std::string& field);
  Eigen::MatrixXd matrix(const std::string& field, Eigen::Index rows, Eigen::Index cols);
  Eigen::MatrixXd covariance(const std::string& field, Eigen::Index dim);

  /// A field that is a case by itself: the same result, its names prefixed.
  Case group(const std::string& field);

  /// A count that the other fields determine.
  void requireCount(const std::string& field, Eigen::Index expected);

  void compareNumber(const std::string& field, double computed, const Tolerance& tolerance);
  void compareVector(const std::string& field, const Eigen::VectorXd& computed,
                     const Tolerance& tolerance);
  void compareMatrix(const std::string& field, const Eigen::MatrixXd& computed,
                     const Tolerance& tolerance);
  /// For what has been read already, or is not in the file as it is computed.
  void compare(const std::string& field, const Eigen::MatrixXd& from_file,
               const Eigen::MatrixXd& computed, const Tolerance& tolerance);

  /// Tells the largest error, relative to the largest entry of the file, and judges nothing.
  /// @param what  was compared with what; the largest error of all cases of the kind is told
  void report(const std::string& what, const Eigen::MatrixXd& from_file,
              const Eigen::MatrixXd& computed);

  /// Fields that nothing looked at are errors: they would pass unchecked.
  void requireAllRead() const;

  [[noreturn]] void fail(const std::string& field, const std::string& why) const;

 private:
  YAML::Node find(const std::string& field);
  double toNumber(const YAML::Node& node, const std::string& field) const;
  Eigen::VectorXd toVector(const YAML::Node& node, const std::string& field) const;

  YAML::Node node_;
  std::string id_;
  std::set<std::string> fields_;
  std::set<std::string> read_;
  KindResult* result_;
};

}  // namespace check
}  // namespace pilco
}  // namespace ddm
