// pilco_check: compares everything that PILCO computes with a file of reference values.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/solver_log.h>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "check/report.h"

namespace {

constexpr int kUsageError = 2;
constexpr char kUsage[] =
    "usage: rosrun ddm_mpc pilco_check FILE.json\n"
    "Compares all cases of a file of reference values with what is computed here.\n"
    "Exit code 0: all within their tolerances; 1: the kinds that are not are named; 2: usage.\n";

}  // namespace

int main(int argc, char** argv) {
  const std::string path = argc == 2 ? argv[1] : "";
  if (path == "-h" || path == "--help") {
    std::cout << kUsage;
    return EXIT_SUCCESS;
  }
  if (path.empty() || path[0] == '-') {
    std::cerr << kUsage;
    return kUsageError;
  }
  ddm::silenceSolverLog();
  try {
    const ddm::pilco::check::Report report = ddm::pilco::check::checkFile(path);
    ddm::pilco::check::print(report, &std::cout);
    return report.passed() ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& e) {
    std::cerr << "pilco_check: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
}
