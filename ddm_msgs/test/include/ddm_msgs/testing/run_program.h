// Runs a program with arguments and standard input, and returns its output and exit code.
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
  int exit_code;    ///< exit code; 128 + signal number if a signal ended the program
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// @param command  command line for a shell
/// @param input    text for standard input
inline Outcome run(const std::string& command, const std::string& input = "") {
  const TempFolder folder;
  const auto text = [&folder](const std::string& name) {
    std::ifstream file(folder.file(name));
    std::ostringstream content;
    content << file.rdbuf();
    return content.str();
  };
  std::ofstream(folder.file("in")) << input;
  const int status = std::system(("(" + command + ") < " + folder.file("in") + " > " +
                                  folder.file("out") + " 2> " + folder.file("err"))
                                     .c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text("out"), text("err")};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace testing
}  // namespace ddm
