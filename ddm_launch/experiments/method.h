// A method: what learns from trials and acts in the next one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/policy.h>
#include <ddm_sim/plant.h>

#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "world.h"

namespace ddm {

/// The seam between Algorithm 1 and who learns in it: the deep dynamical model, or a baseline.
class Method {
 public:
  virtual ~Method() = default;

  /// Learns from all bags.
  virtual TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                                const PhaseCallback& progress) = 0;

  /// The policy of the last training; null before the first.
  virtual std::shared_ptr<Policy> policy() const = 0;
};

/// The method `experiment.method`.
/// @param configuration  outlives the method
/// @param plant          the one that is controlled, outlives the method; a baseline may look at
/// its
///                       true state, nobody else does
std::unique_ptr<Method> makeMethod(const Configuration& configuration, const Plant& plant);

}  // namespace ddm
