// Algorithm 1 of the paper: adaptive MPC in feature space, with either driver.
// SPDX-License-Identifier: BSD-3-Clause
#include "algorithm1.h"

#include <ddm_sim/plant.h>

#include <chrono>
#include <memory>

#include "start.h"

namespace ddm {
namespace {

/// The steps of Algorithm 1. Each step does nothing if an earlier call has completed the step.
class Algorithm1 {
 public:
  Algorithm1(const Configuration& configuration, Driver* driver, RunFolder* folder,
             Progress* progress)
      : configuration_(configuration),
        driver_(*driver),
        folder_(*folder),
        progress_(*progress),
        plant_(makePlant(*configuration.plant)) {}

  void recordTrial(int trial);
  TrainingOutcome updateModel(int trial);
  TrialOutcome evaluate(int trial);
  void finish(int trial, const TrainingOutcome& training, const TrialOutcome& greedy);

 private:
  std::string newBag(const RunId& run);
  PhaseCallback update(double done = 0.0, double share = 1.0) {
    return [this, done, share](double fraction) { progress_.update(done + share * fraction); };
  }

  const Configuration& configuration_;
  Driver& driver_;
  RunFolder& folder_;
  Progress& progress_;
  std::unique_ptr<Plant> plant_;  // only computes errors of recorded states; it is not simulated
};

}  // namespace

void runExperiment(const Configuration& configuration, Driver* driver, RunFolder* folder,
                   Progress* progress,
                   const std::function<void(const std::vector<TrialRow>&)>& show) {
  const auto start = std::chrono::steady_clock::now();
  const int num_trials = configuration.experiment.trials;
  const int num_finished = static_cast<int>(folder->rows().size());
  const bool all_done = num_finished > num_trials;
  announce(configuration, *folder, progress);
  show(folder->rows());
  if (!all_done) resumeTrial(num_finished, configuration, driver, *folder, progress);

  Algorithm1 algorithm(configuration, driver, folder, progress);
  for (int trial = num_finished; trial <= num_trials; ++trial) {
    algorithm.recordTrial(trial);
    const TrainingOutcome training = algorithm.updateModel(trial);
    const TrialOutcome greedy = algorithm.evaluate(trial);
    algorithm.finish(trial, training, greedy);
    show(folder->rows());
  }

  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!all_done || !folder->confirmSummary()) folder->writeSummary(wall_s);
  progress->summary(folder->rows(), folder->path(), wall_s);
}

namespace {

/// Algorithm 1: "Follow a random control strategy and record data" in trial 0; in later trials
/// "u*_t <- epsilon-greedy MPC policy using DDM prediction; apply u*_t and record data" for t = 0
/// ... N - 1. MpcPolicy in ddm_mpc implements the policy itself, eqs. (8) to (10).
void Algorithm1::recordTrial(int trial) {
  const bool random = trial == 0 && configuration_.start.empty();
  progress_.beginPhase(trial, random ? "random" : "explore");
  const int episodes = configuration_.trial.episodes;
  for (int episode = 0; episode < episodes; ++episode) {
    const RunId run = {trial, /*evaluation=*/false, episode};
    if (folder_.isRecorded(run)) {
      progress_.note("trial " + std::to_string(trial) + " is recorded already, in " +
                     folder_.bagPath(trial, episode));
      continue;
    }
    TrialRequest request = requestFor(configuration_, trial, /*evaluation=*/false);
    // Each episode needs its own index, which selects its random draws.
    request.id.trial = static_cast<std::uint32_t>(trial * episodes + episode);
    request.epsilon = random ? 1.0 : configuration_.mpc.epsilon;
    request.bag = newBag(run);
    const double done = static_cast<double>(episode) / episodes;
    folder_.writeRun(run, driver_.runTrial(request, update(done, 1.0 / episodes)));
  }
}

/// "Update DDM with all data collected so far" by train() of ddm_model, eqs. (5a) to (5c).
TrainingOutcome Algorithm1::updateModel(int trial) {
  const TrialId id = requestFor(configuration_, trial, /*evaluation=*/false).id;
  const std::vector<std::string> bags = folder_.bagsUpTo(trial);
  const std::optional<TrainingOutcome> saved = folder_.savedTraining(trial);
  if (saved && driver_.resume(folder_.trainingPath(trial), bags, id)) {
    progress_.note("trial " + std::to_string(trial) + " is trained already");
    return *saved;
  }
  progress_.beginPhase(trial, "train");
  const TrainingOutcome outcome = driver_.train(bags, id, update());
  folder_.writeTraining(trial, outcome);
  return outcome;
}

/// Evaluates the model in a greedy episode (epsilon = 0), which is never trained on (Sec. 4.2).
TrialOutcome Algorithm1::evaluate(int trial) {
  progress_.beginPhase(trial, "evaluate");
  const RunId run = {trial, /*evaluation=*/true};
  TrialRequest request = requestFor(configuration_, trial, /*evaluation=*/true);
  if (configuration_.evaluation.record) request.bag = newBag(run);
  const TrialOutcome greedy = driver_.runTrial(request, update());
  folder_.writeRun(run, greedy);
  return greedy;
}

/// Writes the row of trials.csv. A trial that has a row is never run again.
void Algorithm1::finish(int trial, const TrainingOutcome& training, const TrialOutcome& greedy) {
  TrialRow row = rowOf(requestFor(configuration_, trial, /*evaluation=*/true).id, greedy,
                       configuration_.evaluation, plant_.get());
  row.frames = training.frames;
  row.v_r = training.v_r;
  row.v_p = training.v_p;
  row.train_s = training.seconds;
  row.train_evaluations = training.evaluations;
  row.version = codeVersion();
  folder_.finishTrial(row);
  progress_.finishTrial(folder_.rows());
}

/// Returns a path for the bag of an episode. Bags of an earlier attempt are renamed and kept.
std::string Algorithm1::newBag(const RunId& run) {
  std::vector<std::string> kept;
  const std::string bag = folder_.beginRun(run, &kept);
  for (const std::string& name : kept) {
    progress_.note("trial " + std::to_string(run.trial) + " was begun before, kept its bag as " +
                   name);
  }
  return bag;
}

}  // namespace
}  // namespace ddm
