// pilco_check: all cases of a file, and what is told about them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "check/case.h"

namespace ddm {
namespace pilco {
namespace check {

struct Report {
  std::map<std::string, KindResult> kinds;  ///< those that the file has
  std::vector<std::string> without_cases;   ///< known kinds that it does not have
  std::vector<std::string> unknown;         ///< what it has and nobody knows

  /// Whether everything in the file was compared and is within its tolerance.
  bool passed() const;
};

/// Compares every case of a file. A case that cannot be read is a problem of its kind, the others
/// are compared all the same.
/// @throws std::runtime_error with the path if the file is no object of kinds
Report checkFile(const std::string& path);

/// A table, then each problem by kind, case and field, then the verdict.
void print(const Report& report, std::ostream* out);

}  // namespace check
}  // namespace pilco
}  // namespace ddm
