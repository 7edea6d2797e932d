// Role `trial` of experiment_node: runs one trial, random or with a saved model.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/option_checks.h>
#include <ddm_common/run_node.h>
#include <ddm_mpc/mpc_options.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant.h>

#include <memory>
#include <optional>

#include "evaluation.h"
#include "progress.h"
#include "ros_driver.h"

namespace ddm {
namespace {

/// Block `run`.
struct RunOptions {
  std::string model;      ///< path of the model; empty: a random trial
  std::string bag;        ///< path of the bag to write; empty: nothing is recorded
  double epsilon = 0.0;   ///< probability of a random torque [-]; 1 if there is no model
  int num_steps = 100;    ///< samples [-]
  int seed = 0;           ///< fixes every random draw
  double timeout = 60.0;  ///< longest wall time without any message or progress [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("model", model);
    visitor("bag", bag);
    visitor("epsilon", epsilon);
    visitor("num_steps", num_steps);
    visitor("seed", seed);
    visitor("timeout", timeout);
  }
  std::vector<std::string> problems() const {
    OptionChecks checks("run");
    checks.require(epsilon >= 0.0 && epsilon <= 1.0, "epsilon", "lie in [0, 1]", epsilon);
    checks.require(num_steps >= 1, "num_steps", "be >= 1", num_steps);
    checks.require(seed >= 0, "seed", "be >= 0", seed);
    checks.requireTimeLimit("timeout", timeout);
    return checks.problems();
  }
};

/// @param driver  must outlive an error message, because its destructor waits for the ROS master
void run(const ros::NodeHandle& nh, ParamReader* params, std::optional<RosDriver>* driver) {
  const auto options = params->read<RunOptions>("run");
  const auto plant = readPlant(params);
  const auto mpc = params->read<MpcOptions>("mpc");
  params->requireValid();

  TrialRequest request;
  request.id.seed = static_cast<std::uint64_t>(options.seed);
  request.num_steps = options.num_steps;
  request.epsilon = options.model.empty() ? 1.0 : options.epsilon;
  request.hold_steps = mpc.hold_steps;
  request.bag = options.bag;
  driver->emplace(nh, options.timeout, RosDriver::Peers{!options.bag.empty(), /*trainer=*/false});
  if (!options.model.empty()) (*driver)->useModel(options.model);
  Progress progress;
  progress.beginPhase(0, options.model.empty() ? "random" : "control");
  const TrialOutcome outcome =
      (*driver)->runTrial(request, [&progress](double fraction) { progress.update(fraction); });
  progress.note(std::to_string(outcome.torques.size()) + " torques");
  if (!outcome.states.empty()) {
    const std::unique_ptr<Plant> judge = makePlant(*plant);
    const Evaluation verdict = rowOf(request.id, outcome, {}, judge.get()).evaluation;
    progress.note("final error " + std::to_string(*verdict.final_error) + " " +
                  judge->info().error_unit + ": " +
                  (verdict.success ? "the goal was reached" : "the goal was not reached"));
  }
  if (!options.bag.empty()) progress.note("recorded: " + options.bag);
}

}  // namespace

int trialNode(int argc, char** argv) {
  std::optional<RosDriver> driver;
  return runNode("trial_node", argc, argv,
                 [&driver](auto nh, auto, ParamReader* params) { run(nh, params, &driver); });
}

}  // namespace ddm
