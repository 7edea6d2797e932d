// Parameters of PILCO. One struct is one YAML block; pilco.yaml explains the parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <string>
#include <vector>

namespace ddm::pilco {

/// Block `pilco`: horizon of the predictions and size of the policy.
struct PilcoOptions {
  int horizon = 125;     ///< H, predicted steps [-]
  int num_centres = 30;  ///< centres of the RBF policy [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("horizon", horizon);
    visitor("num_centres", num_centres);
  }
  /// All problems with these values, in words a user can act on. Empty if the values are valid.
  std::vector<std::string> problems() const {
    OptionChecks pilco("pilco");
    pilco.requireWithin("horizon", horizon, 1, 100000);
    pilco.requireWithin("num_centres", num_centres, 1, 1000);
    return pilco.problems();
  }
};

/// Block `gp`: training of the GPs, one GP for each output.
struct GpTrainingOptions {
  int max_iterations = 300;  ///< limit on the BFGS iterations for each output [-]
  int training_points = 0;   ///< size of a random subset for the hyper-parameters; 0: all data [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("max_iterations", max_iterations);
    visitor("training_points", training_points);
  }
  std::vector<std::string> problems() const {
    OptionChecks gp("gp");
    gp.requireWithin("max_iterations", max_iterations, 0, 1000000);
    gp.require(training_points == 0 || training_points >= 2, "training_points", "be 0 or >= 2",
               training_points);
    return gp.problems();
  }
};

/// Block `sparse_gp`: the sparse GP that replaces the full GP for large data.
struct SparseGpOptions {
  int max_points = 300;         ///< largest full GP, and number of inducing inputs [-]
  int first_iterations = 1500;  ///< limit on the first L-BFGS training of the inducing inputs [-]
  int max_iterations = 500;     ///< limit on the L-BFGS training of the inducing inputs later [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("max_points", max_points);
    visitor("first_iterations", first_iterations);
    visitor("max_iterations", max_iterations);
  }
  std::vector<std::string> problems() const {
    OptionChecks sparse_gp("sparse_gp");
    sparse_gp.requireAtLeast("max_points", max_points, 1);
    sparse_gp.requireWithin("first_iterations", first_iterations, 0, 1000000);
    sparse_gp.requireWithin("max_iterations", max_iterations, 0, 1000000);
    return sparse_gp.problems();
  }
};

/// Block `policy_search`: optimisation of the policy.
struct PolicySearchOptions {
  int max_iterations = 75;     ///< limit on the line searches of BFGS in each trial [-]
  int max_evaluations = 1500;  ///< limit on the evaluations of cost and gradient in each trial [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("max_iterations", max_iterations);
    visitor("max_evaluations", max_evaluations);
  }
  std::vector<std::string> problems() const {
    OptionChecks search("policy_search");
    search.requireAtLeast("max_iterations", max_iterations, 0);
    search.requireAtLeast("max_evaluations", max_evaluations, 1);
    return search.problems();
  }
};

/// All blocks of PILCO. No other method reads them.
struct PilcoConfig {
  PilcoOptions pilco;
  GpTrainingOptions gp;
  SparseGpOptions sparse_gp;
  PolicySearchOptions policy_search;
};

}  // namespace ddm::pilco
