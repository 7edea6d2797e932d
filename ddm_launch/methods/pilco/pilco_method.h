// PILCO as a method: Gaussian processes and policy search on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_cache.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "configuration.h"
#include "method.h"
#include "pilco/long_term_cost.h"
#include "pilco/observations.h"

namespace ddm {

/// Where the next training starts: the last policy and the last optimum of the GPs.
struct PilcoMemory {
  Eigen::VectorXd policy;     ///< parameters; empty: none yet
  pilco::GpLearnerState gps;  ///< empty: none yet
  std::string file;           ///< from which it was read, for messages
};

/// Adds the memory to a map, all digits kept, from which readMemory() reads it.
/// @throws std::runtime_error if it is not finite
void writeMemory(const PilcoMemory& memory, YAML::Node* out);

/// @throws std::runtime_error with file and fault
PilcoMemory readMemory(const std::string& file);

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

  PilcoMemory lastMemory(const std::vector<std::string>& bags) const;
  void makePolicy(const ObservedData& observed, int torque_dim);
  void requireFit(const PilcoMemory& memory) const;
  pilco::Propagation learnDynamics(const DataSet& data, const ObservedData& observed,
                                   Training* training) const;
  pilco::LongTermCost improvePolicy(pilco::Propagation dynamics, const PilcoTask& task,
                                    Training* training);
  std::string predictionCsv(const pilco::LongTermCost& cost) const;

  const Configuration& configuration_;
  pilco::PilcoConfig pilco_;
  std::shared_ptr<Observation> observation_;
  BagCache bags_;
  std::optional<pilco::Augmentation> features_;    // of x, what the policy sees
  std::shared_ptr<pilco::SquashedPolicy> policy_;  // null before the first training
};

/// Parameters of the RBF policy of PILCO's first trial: centres drawn from the features of the
/// start distribution, which is taken as Gaussian, small random targets, length-scales of the task.
/// @param features  of the task's state
Eigen::VectorXd drawFirstPolicy(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng);

}  // namespace ddm
