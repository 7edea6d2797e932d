// The three baselines of the paper, PILCO on three kinds of observation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "method.h"

namespace ddm {

/// pilco_state, pilco_features, pilco_pca. None where DDM_PILCO is off.
std::vector<MethodKind> pilcoMethods();

}  // namespace ddm
