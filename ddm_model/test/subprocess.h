// Runs a program as a user would: arguments in, text and exit code out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "ddm_msgs/testing/temp_folder.h"

namespace ddm {
namespace testing {

struct Outcome {
  int exit_code;    ///< -1 if a signal ended the program
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// @param command  program and arguments, as for a shell
inline Outcome run(const std::string& command) {
  const TempFolder folder;
  const auto text = [&folder](const std::string& name) {
    std::ifstream file(folder.file(name));
    std::ostringstream content;
    content << file.rdbuf();
    return content.str();
  };
  const int status = std::system(
      (command + " < /dev/null > " + folder.file("out") + " 2> " + folder.file("err")).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("out"), text("err")};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace testing
}  // namespace ddm
