// Reads and writes what the next training of PILCO starts from, as keys of pilco.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/yaml_text.h>

#include <stdexcept>

#include "pilco/pilco_method.h"

namespace ddm {
namespace {

/// Writes a matrix as a list of its columns.
/// @throws std::runtime_error if the matrix is not finite, because matrixOf() would refuse it
YAML::Node matrixToYaml(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) {
    throw std::runtime_error(
        "PILCO: the policy or the GPs that were found are not finite: check the bags, or lower "
        "policy_search/max_iterations or gp/max_iterations");
  }
  std::vector<std::vector<double>> columns;
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    columns.emplace_back(matrix.col(j).data(), matrix.col(j).data() + matrix.rows());
  }
  return valueToYaml(columns);
}

Eigen::MatrixXd matrixOf(const YAML::Node& memory, const std::string& key) {
  std::vector<std::vector<double>> columns;
  if (!memory[key].IsDefined() || !parseValue(memory[key], &columns)) {
    throw std::runtime_error(key + " must be a list of columns");
  }
  const size_t rows = columns.empty() ? 0 : columns[0].size();
  Eigen::MatrixXd out(rows, columns.size());
  for (size_t j = 0; j < columns.size(); ++j) {
    if (columns[j].size() != rows) throw std::runtime_error(key + " must have columns of one size");
    out.col(j) = Eigen::Map<const Eigen::VectorXd>(columns[j].data(), rows);
  }
  if (!out.allFinite()) throw std::runtime_error(key + " must be finite");
  return out;
}

/// Reads a vector, which is stored as a matrix with one column.
/// @throws std::runtime_error if there are more columns
Eigen::VectorXd vectorOf(const YAML::Node& memory, const std::string& key) {
  const Eigen::MatrixXd matrix = matrixOf(memory, key);
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

PilcoMemory readMemory(const std::string& file) {
  const std::string text = readFile(file);
  try {
    const YAML::Node root = parseYaml(text, file);
    if (!root.IsMap()) throw std::runtime_error("must be a map");
    return {vectorOf(root, "policy"),
            {{matrixOf(root, "log_length_scales"), vectorOf(root, "log_signal_std"),
              vectorOf(root, "log_noise_std")},
             matrixOf(root, "inducing")},
            file};
  } catch (const std::exception& e) {
    throw std::runtime_error(file + ": " + e.what() +
                             ": PILCO goes on from this file, so use another run folder");
  }
}

}  // namespace ddm
