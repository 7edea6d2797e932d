// A method: what learns from trials and acts in the next one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <ddm_mpc/policy.h>
#include <ddm_sim/plant.h>
#include <yaml-cpp/yaml.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "driver.h"

namespace ddm {

/// The seam between Algorithm 1 and who learns in it: the deep dynamical model, or a baseline.
class Method : public Learner {
 public:
  /// The policy of the last training; null before the first.
  virtual std::shared_ptr<Policy> policy() const = 0;
};

/// A value that `experiment/method` may have.
struct MethodKind {
  std::string name;
  std::string about;  ///< a few words, for --help
  /// Effective values of the blocks that it alone reads, by name of the block; what is wrong with
  /// them is kept in the reader.
  std::function<YAML::Node(ParamReader*)> readBlocks;
  /// The configuration and the plant that is controlled outlive the method. A baseline may look at
  /// the plant's true state, nobody else does.
  /// @throws std::invalid_argument if the method does not fit them
  std::function<std::unique_ptr<Method>(const Configuration&, const Plant&)> make;
};

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
