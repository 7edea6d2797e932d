// Paths in a home folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pwd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace ddm {

/// `~/x` and `~name/x` with the home folder, which a shell expands at the start of a word only: not in
/// `--out=~/x`, and not in `runs:=~/x` of roslaunch. Any other text stays as it is.
/// @param word  may be an option with its value, `--out=~/x`
inline std::string expandHome(std::string word) {
  const std::size_t start = word.rfind("--", 0) == 0 ? word.find('=') + 1 : 0;  // npos + 1 is 0
  if (start >= word.size() || word[start] != '~') return word;
  const std::size_t end = std::min(word.find('/', start), word.size());
  const std::string name = word.substr(start + 1, end - start - 1);
  const char* home = name.empty() ? std::getenv("HOME") : nullptr;
  if (!name.empty()) {
    const passwd* const user = ::getpwnam(name.c_str());
    if (user != nullptr) home = user->pw_dir;
  }
  return home == nullptr ? word : word.replace(start, end - start, home);
}

}  // namespace ddm
