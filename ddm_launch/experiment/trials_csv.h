// trials.csv: one row per finished trial.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "run_folder.h"

namespace ddm {

/// Header and rows. success, success_strict and final_error are empty where they are not known, v_r
/// and v_p where the method has no such errors, return where the plant has no reward. final_error
/// is in the unit evaluation/error_unit of config.yaml.
std::string formatTrialsCsv(const std::vector<TrialRow>& rows);

/// A table that an older version wrote, in the columns of today: the version is "?" where none was
/// written. Other texts stay as they are.
std::string inTodaysColumns(const std::string& text);

/// The inverse of formatTrialsCsv(); also reads tables of older versions.
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault
std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source);

}  // namespace ddm
