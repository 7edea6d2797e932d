// Parameters of PILCO in an experiment. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_params/option_checks.h>
#include <ddm_pilco/gp_training.h>
#include <ddm_pilco/policy_search.h>
#include <ddm_pilco/sparse_gp.h>

#include <string>
#include <vector>

namespace ddm {

/// Block `pilco`: the task, and what the policy looks like. Defaults are those of the published
/// runs.
struct PilcoOptions {
  int horizon = 125;               ///< H, predicted steps [-]
  int num_centres = 30;            ///< of the RBF policy [-]
  double cost_width = 0.5;         ///< of the saturating cost, in units of the spread [-]
  double start_std = 0.1;          ///< images: spread of the start, in units of the spread [-]
  double rate_noise = 0.1;         ///< true state: measurement noise, standard deviation [rad/s]
  double angle_noise = 0.01;       ///< the same [rad]
  bool noisy_policy_input = true;  ///< predictions count with the noise that the policy will see

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("horizon", horizon);
    visitor("num_centres", num_centres);
    visitor("cost_width", cost_width);
    visitor("start_std", start_std);
    visitor("rate_noise", rate_noise);
    visitor("angle_noise", angle_noise);
    visitor("noisy_policy_input", noisy_policy_input);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
    OptionChecks pilco("pilco");
    pilco.requireWithin("horizon", horizon, 1, 100000);
    pilco.requireWithin("num_centres", num_centres, 1, 1000);
    pilco.requirePositive("cost_width", cost_width);
    pilco.requireNotNegative("start_std", start_std);
    pilco.requireNotNegative("rate_noise", rate_noise);
    pilco.requireNotNegative("angle_noise", angle_noise);
    return pilco.problems();
  }
};

/// All blocks that PILCO alone reads.
struct PilcoConfig {
  PilcoOptions pilco;
  pilco::GpTrainingOptions gp;
  pilco::SparseGpOptions sparse_gp;
  pilco::PolicySearchOptions policy_search;
};

}  // namespace ddm
