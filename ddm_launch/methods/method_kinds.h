// Which methods there are.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "method.h"

namespace ddm {

/// All that are built, the paper's own first.
std::vector<MethodKind> methodKinds();

std::unique_ptr<Method> makeDdmMethod(const Configuration& configuration, const Plant& plant);
std::unique_ptr<Method> makeOracleMethod(const Configuration& configuration, const Plant& plant);

/// pilco_state, pilco_features, pilco_pca. None where DDM_PILCO is off.
std::vector<MethodKind> pilcoMethods();

/// @throws std::invalid_argument naming what there is, if there is no such method
MethodKind methodKind(const std::string& name);

/// Reads all blocks, those of the method too.
/// @throws std::invalid_argument with all problems
Configuration readWithMethod(ParamReader* reader);

}  // namespace ddm
