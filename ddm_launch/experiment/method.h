// A method: what learns from trials and acts in the next one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/policy.h>
#include <ddm_params/param_reader.h>
#include <ddm_sim/plant.h>
#include <yaml-cpp/yaml.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "driver.h"

namespace ddm {

struct Configuration;

/// The seam between Algorithm 1 and who learns in it: the deep dynamical model, or a baseline.
class Method {
 public:
  virtual ~Method() = default;

  /// Learns from all bags. What an earlier training has left stands in the folders of the bags.
  virtual TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                                const PhaseCallback& progress) = 0;

  /// The policy of the last training; null before the first.
  virtual std::shared_ptr<Policy> policy() const = 0;

  /// Acts by a saved model until the next training.
  /// @return false for a method that has no such models: nothing has changed
  virtual bool useModel(const std::string& /*path*/) { return false; }
};

/// A method with those blocks of the configuration that it alone reads.
class MethodSetup {
 public:
  virtual ~MethodSetup() = default;

  /// Effective values, by name of the block.
  virtual YAML::Node blocks() const = 0;

  /// @param configuration  outlives the method
  /// @param plant          the one that is controlled, outlives the method; a baseline may look at
  ///                       its true state, nobody else does
  /// @throws std::invalid_argument if the method does not fit the configuration or the plant
  virtual std::unique_ptr<Method> make(const Configuration& configuration,
                                       const Plant& plant) const = 0;
};

/// A value that `experiment/method` may have.
struct MethodKind {
  std::string name;
  std::string about;  ///< a few words, for --help
  /// Reads the blocks that are its own; what is wrong with them is kept in the reader.
  std::function<std::shared_ptr<const MethodSetup>(ParamReader*)> read;
};

}  // namespace ddm
