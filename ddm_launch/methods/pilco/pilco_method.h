// PILCO as a method: Gaussian processes of the dynamics and policy search, on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "configuration.h"
#include "method.h"
#include "pilco/observations.h"
#include "pilco/options.h"

namespace ddm {

/// PILCO as a method. After each trial, it trains GPs of the dynamics on all data, then searches the
/// policy that minimises the expected cost over the horizon (Deisenroth and Rasmussen, 2011, Alg.
/// 1). Training k begins with the policy and the hyper-parameters that training k - 1 left in its
/// folder. If the coordinates of the observation have changed, both begin from initial values.
///
/// A training leaves pilco.yaml (statistics, and what the next training needs) and prediction.csv
/// (predicted distributions of states and costs). train() throws std::runtime_error if a file cannot
/// be read or the GPs cannot be trained. resume() reads the policy from pilco.yaml; acting needs no
/// GPs, so that no training is repeated. It throws std::runtime_error if a file is damaged.
/// @param configuration  must outlive the method
std::unique_ptr<Method> makePilcoMethod(const Configuration& configuration,
                                        const pilco::PilcoConfig& options,
                                        std::unique_ptr<Observation> observation);

}  // namespace ddm
