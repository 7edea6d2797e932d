// trials.csv: one row per finished trial.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "run_folder.h"

namespace ddm {

/// Header and rows. success, success_strict and final_error_deg are empty where they are not known,
/// v_r and v_p where the method has no such errors.
std::string formatTrialsCsv(const std::vector<TrialRow>& rows);

/// Tables that older versions wrote have no column `version`: adds it, with "?" in each row. Other
/// texts stay as they are.
std::string withVersions(const std::string& text);

/// The inverse of formatTrialsCsv(); also reads tables without versions.
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault
std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source);

}  // namespace ddm
