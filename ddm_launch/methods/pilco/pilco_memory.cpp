// Reads and writes the file from which the next training of PILCO starts.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/pilco_memory.h"

#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/yaml_text.h>

#include <stdexcept>
#include <vector>

namespace ddm::pilco {
namespace {

/// Converts a matrix to the list of its entries by columns, with all digits.
YAML::Node matrixToYaml(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) {
    throw std::runtime_error(
        "PILCO: the policy or the GPs that were found are not finite: check the bags, or lower "
        "pilco/policy_evaluations or pilco/hyperparameter_iterations");
  }
  return valueToYaml(std::vector<double>(matrix.data(), matrix.data() + matrix.size()));
}

/// Restores a matrix of matrixToYaml().
/// @param cols  number of columns; Eigen::Dynamic: any number
Eigen::MatrixXd matrixOf(const YAML::Node& memory, const std::string& key, Eigen::Index rows,
                         Eigen::Index cols) {
  std::vector<double> entries;
  if (!memory[key].IsDefined() || !parseValue(memory[key], &entries)) {
    throw std::runtime_error(key + " must be a list of numbers");
  }
  const auto size = static_cast<Eigen::Index>(entries.size());
  if (cols == Eigen::Dynamic) cols = size / rows;
  if (size != rows * cols) {
    throw std::runtime_error(textOf(key, " must have ", rows, " x ", cols, " entries, got ", size));
  }
  return Eigen::Map<const Eigen::MatrixXd>(entries.data(), rows, cols);
}

}  // namespace

void addMemory(const Memory& memory, YAML::Node* report) {
  (*report)["policy"] = matrixToYaml(memory.policy);
  (*report)["hyperparameters"] = matrixToYaml(memory.gps.hyperparameters);
  (*report)["inducing"] = matrixToYaml(memory.gps.inducing);
}

Memory readMemory(const std::string& file, const RbfPolicy& policy, int state_dim) {
  const std::string text = readFile(file);
  try {
    const YAML::Node root = parseYaml(text, file);
    if (!root.IsMap()) throw std::runtime_error("must be a map");
    const int gp_inputs = policy.inputDim() + policy.outputDim();
    return {matrixOf(root, "policy", policy.parameters().size(), 1),
            {matrixOf(root, "hyperparameters", gp_inputs + 2, state_dim),
             matrixOf(root, "inducing", gp_inputs, Eigen::Dynamic)}};
  } catch (const std::exception& e) {
    throw std::runtime_error(file + ": " + e.what() +
                             ": PILCO goes on from this file, so use another run folder");
  }
}

}  // namespace ddm::pilco
