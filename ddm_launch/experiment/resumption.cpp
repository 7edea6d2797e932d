// How an experiment takes up what an earlier call left, and the request and the table row of each trial.
// SPDX-License-Identifier: BSD-3-Clause
#include "resumption.h"

#include <ddm_bag_io/bag_cache.h>

#include <algorithm>
#include <stdexcept>

namespace ddm {
namespace {

std::string firstTrial(const StartOptions& start) {
  if (start.empty()) return "a random one";
  return "one that starts from " + std::to_string(start.bags.size()) + " bag(s) and " +
         (start.model.empty() ? "the model trained on them" : "model " + start.model);
}

/// The number of episodes of this trial that an earlier call has recorded completely.
/// @throws std::runtime_error if a bag of this trial or of one before it cannot be read
int requireReadableBags(int trial, const Configuration& configuration, const RunFolder& folder) {
  const ModelConfig& learner = configuration.model;
  BagCache cache(learner.image.size, learner.data_set);
  std::vector<std::string> bags = folder.bagsUpTo(trial - 1);
  if (trial > 0) cache.read(bags);
  int num_recorded = 0;
  for (int episode = 0; episode < configuration.trial.episodes; ++episode) {
    if (!folder.isRecorded({trial, /*evaluation=*/false, episode})) continue;
    ++num_recorded;
    bags.push_back(folder.bagPath(trial, episode));
    try {
      cache.read(bags);
    } catch (const std::exception& e) {
      throw std::runtime_error(std::string(e.what()) + "; this bag is the recording of trial " +
                               std::to_string(trial) + ", which is not finished: repair it, or " +
                               "move it away and the trial is run again");
    }
  }
  return num_recorded;
}

}  // namespace

void announce(const Configuration& configuration, const RunFolder& folder, Progress* progress) {
  const ExperimentOptions& options = configuration.experiment;
  for (const std::string& warning : folder.warnings()) progress->note("warning: " + warning);
  progress->note("preset " + options.preset + ", plant " + options.plant + ", seed " +
                 std::to_string(options.seed) + ", " + std::to_string(options.trials) +
                 " trials after " + firstTrial(configuration.start));
  const int num_finished = static_cast<int>(folder.rows().size());
  if (num_finished > options.trials) {
    progress->note("all " + std::to_string(num_finished) +
                   " trials are finished already: nothing is run");
  } else if (num_finished > 0) {
    progress->note("resuming after trial " + std::to_string(num_finished - 1));
  }
}

void resumeTrial(int trial, const Configuration& configuration, Driver* driver,
                 const RunFolder& folder, Progress* progress) {
  const int num_recorded = requireReadableBags(trial, configuration, folder);
  if (num_recorded == configuration.trial.episodes) return;  // nothing is left to explore
  const StartOptions& start = configuration.start;
  if (trial == 0 && !start.model.empty()) {
    if (driver->useModel(start.model)) return;
    throw std::logic_error("method " + configuration.experiment.method + " cannot use the model " +
                           start.model);
  }
  if (trial == 0 && start.bags.empty()) return;  // the first trial is random
  const int before = std::max(trial - 1, 0);
  const std::vector<std::string> bags = folder.bagsUpTo(trial - 1);
  const TrialId id = requestFor(configuration, before, /*evaluation=*/false).id;
  if (trial > 0 && driver->resume(folder.trainingPath(before), bags, id)) return;
  progress->beginPhase(before, "train");
  driver->train(bags, id, [progress](double fraction) { progress->update(fraction); });
}

TrialRequest requestFor(const Configuration& configuration, int trial, bool evaluation) {
  TrialRequest request;
  request.id.seed = static_cast<std::uint64_t>(configuration.experiment.seed);
  request.id.trial = static_cast<std::uint32_t>(trial);
  request.id.evaluation = evaluation;
  request.num_steps = evaluation ? configuration.evaluation.stepsWith(configuration.trial)
                                 : configuration.trial.num_steps;
  request.hold_steps = configuration.mpc.hold_steps;
  return request;
}

TrialRow rowOf(const TrialId& id, const TrialOutcome& greedy, const EvaluationOptions& options,
               Plant* plant) {
  TrialRow row;
  row.seed = static_cast<int>(id.seed);
  row.trial = static_cast<int>(id.trial);
  plant->setGoal(goalOf(*plant, id.seed, id.trial, id.evaluation));
  row.evaluation = greedy.states.empty()
                       ? evaluateFeatures(greedy.goal_distances, options)
                       : evaluate(*plant, greedy.states, greedy.torques, options, greedy.times);
  row.plan_ms_median = 1e3 * quantile(greedy.solve_times, 0.5);
  row.plan_ms_p99 = 1e3 * quantile(greedy.solve_times, 0.99);
  return row;
}

}  // namespace ddm
