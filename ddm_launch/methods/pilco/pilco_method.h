// PILCO as a method: Gaussian processes and policy search on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_cache.h>
#include <ddm_pilco/long_term_cost.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "method.h"
#include "observations.h"

namespace ddm {

/// Where the next training starts: the last policy and the last optimum of the GPs.
struct PilcoMemory {
  Eigen::VectorXd policy;     ///< parameters; empty: none yet
  pilco::GpLearnerState gps;  ///< empty: none yet
};

/// As keys that writeMemory() adds and readMemory() takes, all digits kept.
void writeMemory(const PilcoMemory& memory, YAML::Node* out);

/// @param text    YAML that holds those keys
/// @param source  file, for messages
/// @throws std::runtime_error with source and fault
PilcoMemory readMemory(const std::string& text, const std::string& source);

/// After each trial: GPs of the dynamics from all data, then the policy that minimises the expected
/// cost over the horizon (Deisenroth and Rasmussen, 2011, Alg. 1). Training k goes on from the
/// policy and the hyper-parameters that training k - 1 left in its folder, unless the coordinates
/// have changed: then both start afresh.
///
/// Leaves pilco.yaml (how the training went, and what the next one needs) and prediction.csv (the
/// predicted distribution of states and costs).
class PilcoMethod : public Method {
 public:
  /// @param configuration  outlives the method
  PilcoMethod(const Configuration& configuration, const pilco::PilcoConfig& pilco,
              std::unique_ptr<Observation> observation);

  /// @throws std::runtime_error if a file cannot be read or the GPs cannot be trained
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override;
  /// By the policy in pilco.yaml; GPs are needed for training alone.
  /// @throws std::runtime_error if a file is damaged
  bool resume(const std::string& folder, const std::vector<std::string>& bags,
              const TrialId& id) override;
  std::shared_ptr<Policy> policy() const override;

 private:
  struct Training;

  void makePolicy(int num_features, int torque_dim);
  PilcoMemory lastMemory(const std::vector<std::string>& bags) const;
  pilco::Propagation learnDynamics(const DataSet& data, const Eigen::MatrixXd& X,
                                   const PilcoTask& task, Training* training) const;
  pilco::LongTermCost improvePolicy(pilco::Propagation dynamics, const PilcoTask& task,
                                    const std::vector<std::string>& bags, Training* training);
  std::string predictionCsv(const pilco::LongTermCost& cost) const;

  const Configuration& configuration_;
  pilco::PilcoConfig pilco_;
  std::shared_ptr<Observation> observation_;
  BagCache bags_;
  std::shared_ptr<pilco::SquashedPolicy> policy_;  // null before the first training
};

}  // namespace ddm
