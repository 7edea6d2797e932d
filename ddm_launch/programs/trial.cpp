// Role `trial` of experiment_node: runs one trial, random or with a saved model.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/run_node.h>
#include <ddm_mpc/mpc_options.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant.h>

#include <memory>
#include <optional>

#include "configuration.h"
#include "evaluation.h"
#include "progress.h"
#include "ros_driver.h"

namespace ddm {
namespace {

/// Block `run`.
struct RunOptions {
  std::string model;  ///< path of the model; empty: a random trial
  std::string bag;    ///< path of the bag to write; empty: nothing is recorded

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("model", model);
    visitor("bag", bag);
  }
  std::vector<std::string> problems() const { return {}; }
};

/// @param driver  must outlive an error message, because its destructor waits for the ROS master
void run(const ros::NodeHandle& nh, ParamReader* params, std::optional<RosDriver>* driver) {
  const auto options = params->read<RunOptions>("run");
  const auto experiment = params->read<ExperimentOptions>("experiment");
  const auto trial = params->read<TrialOptions>("trial");
  const auto plant = readPlant(params);
  const auto mpc = params->read<MpcOptions>("mpc");
  params->requireValid();

  TrialRequest request;
  request.id.seed = static_cast<std::uint64_t>(experiment.seed);
  request.num_steps = trial.num_steps;
  request.epsilon = options.model.empty() ? 1.0 : mpc.epsilon;
  request.hold_steps = mpc.hold_steps;
  request.bag = options.bag;
  driver->emplace(nh, experiment.timeout,
                  RosDriver::Peers{!options.bag.empty(), /*trainer=*/false});
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
