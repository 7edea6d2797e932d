// One case of a file of reference values: its fields, and their comparison with what is computed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "ddm_pilco/gp_model.h"
#include "ddm_pilco/gp_training.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"

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

constexpr Tolerance kClosedForm = absolute(1e-12);

/// What a file calls mean, covariance and gain of an output, in this order.
struct MomentField {
  std::string name;
  Tolerance tolerance;
};
using MomentFields = std::vector<MomentField>;

void compareMoments(Case* reference, const MomentFields& fields, const Moments& computed);

/// Compares the derivatives of these fields in mean m and covariance of the input, where the file
/// has them. They are vectorised by columns.
/// @param covariance  what the file calls the covariance of the input
/// @param backward    dJ/d outputs -> dJ/d input
void compareJacobians(Case* reference, const MomentFields& fields, const std::string& covariance,
                      int dim, int output_dim,
                      const std::function<Gaussian(const Moments&)>& backward);

struct GpData {
  Eigen::MatrixXd inputs;   ///< [D x n]
  Eigen::MatrixXd targets;  ///< [n x E]
};

/// The fields X and Y.
GpData readGpData(Case* reference);

/// Rows: log length-scales, log signal std, log noise std. One column for each output.
Hyperparameters readHyperparameters(Case* reference, const std::string& field, const GpData& data);
Eigen::MatrixXd toMatrix(const Hyperparameters& hyperparameters);

/// @throws std::invalid_argument where `loghyp` makes the covariance lose positive definiteness
GpModel usable(const GpFit& fit);

/// The GP of the data and the field loghyp.
GpModel readModel(Case* reference, const GpData& data);

/// Compares the field loghyp_init, and trains from there.
GpFit trainFromStart(Case* reference, const GpData& data);

/// Parameters of an RBF policy from their parts.
/// @param group  that the fields are in, with a slash
Eigen::VectorXd readParameters(Case* reference, int dim, int controls,
                               const std::string& group = "");
std::unique_ptr<RbfPolicy> readRbfPolicy(Case* reference, int dim, int controls);

/// Computes one case and compares all of its fields.
using Check = void (*)(Case* reference);

/// By the names that the kinds have in a file.
const std::map<std::string, Check>& kinds();

// Those of the pendulum, in pendulum_kinds.cpp.
void checkSimulation(Case* reference);
void checkPropagation(Case* reference);
void checkValue(Case* reference);
void checkAuthors(Case* reference);

}  // namespace ddm::pilco::check
