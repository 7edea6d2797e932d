// Where the next training of PILCO starts, as keys of pilco.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_value.h>
#include <ddm_common/yaml_text.h>

#include <stdexcept>

#include "pilco_method.h"

namespace ddm {
namespace {

/// A matrix as a list of its columns.
/// @throws std::runtime_error if it is not finite, since matrixOf() would refuse it
YAML::Node matrixToYaml(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) {
    throw std::runtime_error(
        "PILCO: the policy or the GPs that were found are not finite: check the bags, or lower "
        "policy_search/max_iterations or gp/max_iterations");
  }
  YAML::Node out(YAML::NodeType::Sequence);
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    YAML::Node column(YAML::NodeType::Sequence);
    column.SetStyle(YAML::EmitterStyle::Flow);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) column.push_back(valueToYaml(matrix(i, j)));
    out.push_back(column);
  }
  return out;
}

/// @param max_numbers  that can be there at all: aliases would make much of little
Eigen::MatrixXd matrixOf(const YAML::Node& memory, const std::string& key, size_t max_numbers) {
  const YAML::Node columns = memory[key];
  if (!columns.IsDefined() || !columns.IsSequence()) {
    throw std::runtime_error(key + " must be a list of columns");
  }
  const auto rows = columns.size() == 0 ? 0 : columns[0].size();
  if (columns.size() > 0 && rows > max_numbers / columns.size()) {
    throw std::runtime_error(key + " is longer than the file");
  }
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns.size()));
  for (size_t j = 0; j < columns.size(); ++j) {
    if (!columns[j].IsSequence() || columns[j].size() != rows)
      throw std::runtime_error(key + " must have columns of one size");
    for (size_t i = 0; i < rows; ++i) {
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = columns[j][i].as<double>();
    }
  }
  if (!out.allFinite()) throw std::runtime_error(key + " must be finite");
  return out;
}

/// The single column that a vector is kept as.
Eigen::VectorXd vectorOf(const YAML::Node& memory, const std::string& key, size_t max_numbers) {
  const Eigen::MatrixXd matrix = matrixOf(memory, key, max_numbers);
  if (matrix.cols() != 1) throw std::runtime_error(key + " must be one column");
  return matrix.col(0);
}

}  // namespace

void writeMemory(const PilcoMemory& memory, YAML::Node* out) {
  (*out)["policy"] = matrixToYaml(memory.policy);
  (*out)["log_length_scales"] = matrixToYaml(memory.gps.hyperparameters.log_length_scales);
  (*out)["log_signal_std"] = matrixToYaml(memory.gps.hyperparameters.log_signal_std);
  (*out)["log_noise_std"] = matrixToYaml(memory.gps.hyperparameters.log_noise_std);
  (*out)["inducing"] = matrixToYaml(memory.gps.inducing);
}

PilcoMemory readMemory(const std::string& text, const std::string& source) {
  try {
    const YAML::Node root = parseYaml(text, source);
    if (!root.IsMap()) throw std::runtime_error("must be a map");
    PilcoMemory memory;
    memory.policy = vectorOf(root, "policy", text.size());
    memory.gps.hyperparameters = {matrixOf(root, "log_length_scales", text.size()),
                                  vectorOf(root, "log_signal_std", text.size()),
                                  vectorOf(root, "log_noise_std", text.size())};
    memory.gps.inducing = matrixOf(root, "inducing", text.size());
    return memory;
  } catch (const std::exception& e) {
    throw std::runtime_error(source + ": " + e.what() +
                             ": PILCO goes on from this file, so use another run folder");
  }
}

}  // namespace ddm
