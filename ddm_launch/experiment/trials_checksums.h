// .trials.crc32: what trials.csv was after each trial, so that no byte of it changes unnoticed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "run_folder.h"

namespace ddm {

/// Line k is the CRC-32 of trials.csv as it was with k rows, k = 1, 2, ... Therefore the checksums
/// may be written before the table: if the program ends between, the table still has its line.
std::string formatTrialsChecksums(const std::vector<TrialRow>& rows);

/// @param trials_csv  the table, with `num_rows` rows
/// @return            whether it is the one that the checksums were made of, be it in the columns
///                    of an older version
bool isUnchanged(const std::string& trials_csv, size_t num_rows, const std::string& checksums);

}  // namespace ddm
