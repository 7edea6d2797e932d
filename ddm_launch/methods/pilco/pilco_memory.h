// What PILCO carries from trial to trial, as a file.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_pilco/sparse_gp.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <string>

namespace ddm {

/// Where the next training starts: the last policy and the last optimum of the GPs.
struct PilcoMemory {
  Eigen::VectorXd policy;     ///< parameters; empty: none yet
  pilco::GpLearnerState gps;  ///< empty: none yet
};

/// As keys that writeMemory() adds and readMemory() takes, all digits kept.
void writeMemory(const PilcoMemory& memory, YAML::Node* out);

/// @param text    YAML that holds those keys
/// @param source  file, for messages
/// @throws std::runtime_error with source and fault
PilcoMemory readMemory(const std::string& text, const std::string& source);

}  // namespace ddm
