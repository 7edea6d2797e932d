// Defines pilcoMethods() for builds without PILCO.
// SPDX-License-Identifier: BSD-3-Clause
#include "method.h"

namespace ddm {

std::vector<MethodKind> pilcoMethods() { return {}; }

}  // namespace ddm
