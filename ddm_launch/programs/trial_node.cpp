// trial_node: one trial with the real nodes, random or with a saved model, recorded or not.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_mpc/mpc_options.h>
#include <ddm_node/node_params.h>
#include <ddm_params/param_reader.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_sim/plant_factory.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>

#include "evaluation.h"
#include "leave.h"
#include "progress.h"
#include "ros_driver.h"

namespace {

/// Block `run`.
struct RunOptions {
  std::string model;      ///< model file; empty: a random trial
  std::string bag;        ///< bag to write; empty: nothing is recorded
  double epsilon = 0.0;   ///< probability of a random torque; 1 where there is no model [-]
  int num_steps = 100;    ///< frames [-]
  int seed = 0;           ///< fixes every random draw
  double timeout = 60.0;  ///< wall time without a sign of life [s]

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
    std::vector<std::string> out;
    if (!(epsilon >= 0.0 && epsilon <= 1.0)) {
      out.push_back("run/epsilon must lie in [0, 1], got " + std::to_string(epsilon));
    }
    if (num_steps < 1) {
      out.push_back("run/num_steps must be >= 1, got " + std::to_string(num_steps));
    }
    if (seed < 0) out.push_back("run/seed must be >= 0, got " + std::to_string(seed));
    if (!(timeout > 0.0)) {
      out.push_back("run/timeout must be > 0, got " + std::to_string(timeout));
    }
    return out;
  }
};

void report(const ddm::Plant& plant, const ddm::TrialOutcome& outcome,
            ddm::EvaluationOptions options, ddm::Progress* progress) {
  options.complete(plant.info());
  const bool enough = static_cast<int>(outcome.states.size()) >= options.settled_steps_strict;
  progress->note(std::to_string(outcome.torques.size()) + " torques");
  if (!enough) return;
  const ddm::Evaluation evaluation = ddm::evaluate(plant, outcome.states, outcome.torques, options);
  progress->note("final error " + std::to_string(*evaluation.final_error) + " " +
                 options.error_unit + ": " +
                 (evaluation.success ? "the goal was reached" : "the goal was not reached"));
}

/// What it has of ROS: outlives the error that ends it.
struct Node {
  ros::NodeHandle nh;
  ros::NodeHandle pnh{"~"};
  std::optional<ddm::RosDriver> driver;
};

void run(Node* node) {
  const ros::NodeHandle& pnh = node->pnh;
  ddm::ParamReader params(ddm::nodeParams(pnh), pnh.getNamespace());
  const auto options = params.read<RunOptions>("run");
  const auto plant = ddm::readPlant(&params);
  const auto evaluation = params.read<ddm::EvaluationOptions>("evaluation");
  const auto mpc = params.read<ddm::MpcOptions>("mpc");
  params.requireValid();

  ddm::TrialRequest request;
  request.id.seed = static_cast<std::uint64_t>(options.seed);
  request.num_steps = options.num_steps;
  request.epsilon = options.model.empty() ? 1.0 : options.epsilon;
  request.hold_steps = mpc.hold_steps;
  request.bag = options.bag;
  node->driver.emplace(node->nh, options.timeout,
                       ddm::RosDriver::Peers{!options.bag.empty(), /*trainer=*/false});
  if (!options.model.empty()) node->driver->useModel(options.model);
  ddm::Progress progress(&std::cout, ::isatty(STDOUT_FILENO) != 0, 0);
  progress.beginPhase(0, options.model.empty() ? "random" : "control");
  const ddm::TrialOutcome outcome =
      node->driver->runTrial(request, [&progress](double fraction) { progress.update(fraction); });
  const std::unique_ptr<ddm::Plant> judge = ddm::makePlant(*plant);
  judge->setGoal(ddm::goalOf(*judge, request.id.seed, request.id.trial, request.id.evaluation));
  report(*judge, outcome, evaluation, &progress);
  if (!options.bag.empty()) progress.note("recorded: " + options.bag);
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "trial_node");
  Node node;  // outside the try: its destructor shuts the log down
  int code = EXIT_SUCCESS;
  try {
    run(&node);
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("trial: " << e.what());
    code = EXIT_FAILURE;
  }
  ddm::leaveWithin10s(code);
  return code;
}
