// Interface of a method, which learns from trials and acts in the next one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <ddm_mpc/planner.h>
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

/// Interface between Algorithm 1 and a learner: the deep dynamical model or a baseline.
class Method : public Learner {
 public:
  /// The policy of the latest training; null before the first training.
  virtual std::shared_ptr<Policy> policy() const = 0;
};

/// One of the values of `experiment/method`.
struct MethodKind {
  std::string name;
  std::string about;  ///< short description for --help
  /// Reads the blocks that only this method has and returns their effective values by block name.
  /// The reader collects all problems.
  std::function<YAML::Node(ParamReader*)> readBlocks;
  /// Makes the method. Configuration and plant must outlive it. Only a baseline may look at the
  /// true state of the plant.
  /// @throws std::invalid_argument if the method does not fit configuration and plant
  std::function<std::unique_ptr<Method>(const Configuration&, const Plant&)> make;
};

/// All methods of this build. The first is the paper's.
std::vector<MethodKind> methodKinds();

std::unique_ptr<Method> makeDdmMethod(const Configuration& configuration, const Plant& plant);
std::unique_ptr<Method> makeOracleMethod(const Configuration& configuration, const Plant& plant);

/// Cost of a plan U from the present state of a plant, with a second plant as the model:
///
///   J(U) = sum_{k=1}^{K} |p_k - p_goal|^2 + lambda |u_{k-1}|^2
///   state_{k+1} = model(state_k, u_k)
///
/// p is the position of the moving part in the image, Plant::visiblePosition(). For the pendulum, p
/// lies on a circle, as the features do after training. The planner therefore solves the same
/// problem as with the DDM, but with a perfect model. The gradient is computed backwards through
/// the steps; the Jacobian of each step is computed by central differences.
/// @param plant  its state and its goal are used; must outlive the cost
std::unique_ptr<PlanCost> makeOracleCost(const Plant& plant, std::unique_ptr<Plant> model,
                                         int horizon, double control_weight);

/// pilco_state, pilco_features and pilco_pca. Defined if the CMake option DDM_PILCO is on.
std::vector<MethodKind> pilcoMethods();

/// @throws std::invalid_argument listing all methods, if none has this name
MethodKind methodKind(const std::string& name);

/// Reads all blocks, including those of the method.
/// @throws std::invalid_argument listing all problems
Configuration readWithMethod(ParamReader* reader);

}  // namespace ddm
