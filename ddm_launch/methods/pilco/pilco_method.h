// PILCO as a method: Gaussian processes of the dynamics and policy search, on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_cache.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "configuration.h"
#include "method.h"
#include "pilco/long_term_cost.h"
#include "pilco/observations.h"

namespace ddm {

/// After each trial, PILCO trains GPs of the dynamics on all data, then searches the policy that
/// minimises the expected cost over the horizon (Deisenroth and Rasmussen, 2011, Alg. 1). Training
/// k begins with the policy and the hyper-parameters that training k - 1 left in its folder. If the
/// coordinates of the observation have changed, both begin from initial values.
///
/// A training leaves pilco.yaml (statistics, and what the next training needs) and prediction.csv
/// (predicted distributions of states and costs).
class PilcoMethod : public Method {
 public:
  /// @param configuration  must outlive the method
  PilcoMethod(const Configuration& configuration, const pilco::PilcoConfig& pilco,
              std::unique_ptr<Observation> observation);

  /// @throws std::runtime_error if a file cannot be read or the GPs cannot be trained
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override;
  /// Reads the policy from pilco.yaml. Acting needs no GPs, so that no training is repeated.
  /// @throws std::runtime_error if a file is damaged
  bool resume(const std::string& folder, const std::vector<std::string>& bags,
              const TrialId& id) override;
  std::shared_ptr<Policy> policy() const override;

 private:
  struct Memory;
  struct Training;

  Memory readMemory(const std::string& file) const;
  Memory lastMemory(const std::vector<std::string>& bags) const;
  void makePolicy(const ObservedData& observed, int torque_dim);
  pilco::Propagation learnDynamics(const DataSet& data, const ObservedData& observed,
                                   Training* training) const;
  pilco::LongTermCost improvePolicy(pilco::Propagation dynamics, const PilcoTask& task,
                                    Training* training);

  const Configuration& configuration_;
  pilco::PilcoConfig pilco_;
  std::shared_ptr<Observation> observation_;
  BagCache bags_;
  std::optional<pilco::Augmentation> features_;  // maps x to the input of the policy
  std::shared_ptr<pilco::RbfPolicy> policy_;     // null before the first training
};

}  // namespace ddm
