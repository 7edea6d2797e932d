// trials.csv: one row per finished trial, and the checksums that show when it was changed.
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

/// The inverse of formatTrialsCsv().
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault
std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source);

/// Line k of .trials.crc32 is the CRC-32 of trials.csv as it was with k rows, k = 1, 2, ...
/// Therefore the checksums may be written before the table: if the program ends between, the table
/// still has its line.
std::string formatTrialsChecksums(const std::vector<TrialRow>& rows);

/// @param trials_csv  the table, with `num_rows` rows
/// @return            whether it is the one that the checksums were made of
bool isUnchanged(const std::string& trials_csv, size_t num_rows, const std::string& checksums);

}  // namespace ddm
