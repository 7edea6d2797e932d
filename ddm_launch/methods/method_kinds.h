// Which methods there are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "method.h"

namespace ddm {

/// All that are built, the paper's own first.
std::vector<MethodKind> methodKinds();

/// @throws std::invalid_argument naming what there is, if there is no such method
MethodKind methodKind(const std::string& name);

}  // namespace ddm
