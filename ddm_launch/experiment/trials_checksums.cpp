// .trials.crc32: what trials.csv was after each trial, so that no byte of it changes unnoticed.
// SPDX-License-Identifier: BSD-3-Clause
#include "trials_checksums.h"

#include <ddm_model/model_file.h>

#include <sstream>

#include "trials_csv.h"

namespace ddm {

std::string formatTrialsChecksums(const std::vector<TrialRow>& rows) {
  std::string lines;
  for (size_t k = 1; k <= rows.size(); ++k) {
    lines += checksum(formatTrialsCsv({rows.begin(), rows.begin() + static_cast<long>(k)})) + "\n";
  }
  return lines;
}

bool isUnchanged(const std::string& trials_csv, size_t num_rows, const std::string& checksums) {
  std::istringstream lines(checksums);
  std::string line;
  for (size_t k = 0; k < num_rows; ++k) {
    if (!std::getline(lines, line)) return false;
  }
  return num_rows == 0 || line == checksum(trials_csv) ||
         line == checksum(inTodaysColumns(trials_csv));
}

}  // namespace ddm
