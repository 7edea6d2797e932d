// Reads and writes the file from which the next training of PILCO starts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <string>

#include "pilco/gp.h"
#include "pilco/policy.h"

namespace ddm::pilco {

/// Where the next training starts: the latest policy and the latest optimum of the GPs.
struct Memory {
  Eigen::VectorXd policy;  ///< parameters of the policy; empty if there is none yet
  GpLearnerState gps;      ///< empty if there is none yet
};

/// Adds the memory to a report.
/// @throws std::runtime_error if the memory is not finite, because readMemory() would refuse it
void addMemory(const Memory& memory, YAML::Node* report);

/// Reads the memory from the file of a report.
/// @param policy     policy that gets the parameters
/// @param state_dim  entries of x, which are the outputs of the GPs
/// @throws std::runtime_error with path and reason if the file is damaged or does not fit
Memory readMemory(const std::string& file, const RbfPolicy& policy, int state_dim);

}  // namespace ddm::pilco
