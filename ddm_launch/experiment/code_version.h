// Which version of the code is running.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// Version of the package and commit, "0.1.0 (1a2b3c4)".
std::string codeVersion();

}  // namespace ddm
