// Which version of the code is running.
// SPDX-License-Identifier: BSD-3-Clause
#include "code_version.h"

#include "version.h"

namespace ddm {

std::string codeVersion() { return DDM_CODE_VERSION; }

}  // namespace ddm
