// PILCO as a method: Gaussian processes of the dynamics and policy search, on an observation.
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

/// Where the next training starts: the latest policy and the latest optimum of the GPs.
struct PilcoMemory {
  Eigen::VectorXd policy;     ///< parameters of the policy; empty if there is none yet
  pilco::GpLearnerState gps;  ///< empty if there is none yet
  std::string file;           ///< path of the file it was read from, for error messages
};

/// Adds the memory to a YAML map with all digits, so that readMemory() restores it exactly.
/// @throws std::runtime_error if the memory is not finite
void writeMemory(const PilcoMemory& memory, YAML::Node* out);

/// @throws std::runtime_error with path and reason
PilcoMemory readMemory(const std::string& file);

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
  std::optional<pilco::Augmentation> features_;    // maps x to the input of the policy
  std::shared_ptr<pilco::SquashedPolicy> policy_;  // null before the first training
};

/// Draws the parameters of the first RBF policy. The centres are drawn from the features of p(x_0),
/// which are approximated by a Gaussian; the targets are small random numbers; the length-scales
/// are those of the task.
/// @param features  features of the task's state
Eigen::VectorXd drawFirstPolicy(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng);

}  // namespace ddm
