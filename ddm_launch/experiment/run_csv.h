// torques.csv and trajectory.csv: torque and true state at each step of a run.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

/// The torques of a run, and which of them were exploratory.
struct TorqueRows {
  std::vector<Eigen::VectorXd> torques;
  std::vector<bool> exploratory;  ///< as many
};

/// Header and one row per step.
/// @param names  of the torques
/// @throws std::invalid_argument if a row has another number of torques
std::string formatTorquesCsv(const TorqueRows& rows, const std::vector<std::string>& names);

/// The inverse.
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault
TorqueRows parseTorquesCsv(const std::string& text, const std::vector<std::string>& names,
                           const std::string& source);

/// Header and one row per frame.
/// @param times   since the first frame [s]
/// @param states  as many
/// @param names   of the components of a state, with units
std::string formatTrajectoryCsv(const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& states,
                                const std::vector<std::string>& names);

/// The states, exactly as they were written.
/// @param source  file, for messages
/// @return        one state per column  [names.size() x frames]
/// @throws std::runtime_error with source, line and fault
Eigen::MatrixXd parseTrajectoryCsv(const std::string& text, const std::vector<std::string>& names,
                                   const std::string& source);

}  // namespace ddm
