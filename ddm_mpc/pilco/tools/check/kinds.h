// The kinds of cases that a file of reference values may have.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "check/case.h"

namespace ddm::pilco::check {

/// Computes one case and compares all of its fields.
using Check = void (*)(Case* reference);

/// By the names that the kinds have in a file.
const std::map<std::string, Check>& kinds();

// Those of the pendulum, in pendulum_kinds.cpp.
void checkSimulation(Case* reference);
void checkPropagation(Case* reference);
void checkValue(Case* reference);
void checkAuthors(Case* reference);

}  // namespace ddm::pilco::check
