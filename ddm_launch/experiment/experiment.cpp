// Algorithm 1 of the paper: adaptive MPC in feature space, whoever runs its trials.
// SPDX-License-Identifier: BSD-3-Clause
#include "experiment.h"

#include <ddm_bag_io/bag_cache.h>
#include <ddm_sim/plant_factory.h>

#include <chrono>
#include <optional>
#include <stdexcept>

#include "evaluation.h"

namespace ddm {
namespace {

/// One pass through the loop of Algorithm 1, in four phases.
class Loop {
 public:
  Loop(const Configuration& configuration, Driver* driver, RunFolder* folder, Progress* progress)
      : configuration_(configuration),
        driver_(*driver),
        folder_(*folder),
        progress_(*progress),
        plant_(makePlant(*configuration.plant)),
        update_([progress](double fraction) { progress->update(fraction); }) {}

  /// What trial 0 explores with.
  void startFirstTrial() {
    const StartOptions& start = configuration_.start;
    if (!start.model.empty()) {
      if (!driver_.useModel(start.model)) {
        throw std::logic_error("method " + configuration_.experiment.method +
                               " cannot use the model " + start.model);
      }
    } else if (!start.bags.empty()) {
      progress_.beginPhase(0, "train");
      driver_.train(start.bags, idOf(0), update_);
    }
  }

  /// Prepares a trial that an earlier call may have begun. A bag that its training could not read is
  /// refused here, before anything moves.
  void resume(int trial) {
    const ModelConfig& learner = configuration_.model;
    BagCache cache(learner.image.size, learner.data_set);
    std::vector<std::string> bags = bagsUpTo(trial - 1);
    if (trial > 0) cache.read(bags);
    int num_recorded = 0;
    for (int episode = 0; episode < configuration_.trial.episodes; ++episode) {
      if (!folder_.isRecorded({trial, /*evaluation=*/false, episode})) continue;
      ++num_recorded;
      bags.push_back(folder_.bagPath(trial, episode));
      try {
        cache.read(bags);
      } catch (const std::exception& e) {
        throw std::runtime_error(std::string(e.what()) + "; this bag is the recording of trial " +
                                 std::to_string(trial) + ", which is not finished: repair it, or " +
                                 "move it away and the trial is run again");
      }
    }
    if (num_recorded == configuration_.trial.episodes) return;  // nothing is left to explore
    if (trial == 0) return startFirstTrial();
    if (!driver_.resume(folder_.trainingPath(trial - 1), bagsUpTo(trial - 1), idOf(trial - 1))) {
      train(trial - 1);
    }
  }

  void recordTrial(int trial) {
    const bool random = trial == 0 && configuration_.start.empty();
    progress_.beginPhase(trial, random ? "random" : "explore");
    const int episodes = configuration_.trial.episodes;
    for (int episode = 0; episode < episodes; ++episode) {
      if (folder_.isRecorded({trial, /*evaluation=*/false, episode})) {
        progress_.note("trial " + std::to_string(trial) + " is recorded already, in " +
                       folder_.bagPath(trial, episode));
        continue;
      }
      TrialRequest request = requestFor(configuration_, trial, /*evaluation=*/false);
      request.id.trial = static_cast<std::uint32_t>(trial * episodes + episode);  // its own draws
      request.epsilon = random ? 1.0 : configuration_.mpc.epsilon;
      request.bag = newBag({trial, /*evaluation=*/false, episode});
      const auto update = [&](double fraction) {
        progress_.update((episode + fraction) / episodes);
      };
      folder_.writeRun({trial, /*evaluation=*/false, episode}, driver_.runTrial(request, update));
    }
  }

  /// Trains on all bags, unless an earlier call did.
  TrainingOutcome learn(int trial) {
    const std::optional<TrainingOutcome> saved = folder_.savedTraining(trial);
    if (saved && driver_.resume(folder_.trainingPath(trial), bagsUpTo(trial), idOf(trial))) {
      progress_.note("trial " + std::to_string(trial) + " is trained already");
      return *saved;
    }
    const TrainingOutcome outcome = train(trial);
    folder_.writeTraining(trial, outcome);
    return outcome;
  }

  TrialOutcome evaluateGreedily(int trial) {
    progress_.beginPhase(trial, "evaluate");
    TrialRequest request = requestFor(configuration_, trial, /*evaluation=*/true);
    if (configuration_.evaluation.record) request.bag = newBag({trial, /*evaluation=*/true});
    return driver_.runTrial(request, update_);
  }

  void finish(int trial, const TrainingOutcome& training, const TrialOutcome& greedy) {
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

 private:
  TrainingOutcome train(int trial) {
    progress_.beginPhase(trial, "train");
    return driver_.train(bagsUpTo(trial), idOf(trial), update_);
  }

  /// Of the training after a trial.
  TrialId idOf(int trial) const {
    return requestFor(configuration_, trial, /*evaluation=*/false).id;
  }

  std::vector<std::string> bagsUpTo(int trial) const {
    std::vector<std::string> bags = configuration_.start.bags;
    for (int k = 0; k <= trial; ++k) {
      for (int episode = 0; episode < configuration_.trial.episodes; ++episode) {
        bags.push_back(folder_.bagPath(k, episode));
      }
    }
    return bags;
  }

  std::string newBag(const RunId& run) {
    std::vector<std::string> kept;
    const std::string bag = folder_.beginRun(run, &kept);
    for (const std::string& name : kept) {
      progress_.note("trial " + std::to_string(run.trial) + " was begun before, kept its bag as " +
                     name);
    }
    return bag;
  }

  const Configuration& configuration_;
  Driver& driver_;
  RunFolder& folder_;
  Progress& progress_;
  std::unique_ptr<Plant> plant_;
  PhaseCallback update_;
};

std::string firstTrial(const StartOptions& start) {
  if (start.empty()) return "a random one";
  return "one that starts from " + std::to_string(start.bags.size()) + " bag(s) and " +
         (start.model.empty() ? "the model trained on them" : "model " + start.model);
}

}  // namespace

void runExperiment(const Configuration& configuration, Driver* driver, RunFolder* folder,
                   Progress* progress,
                   const std::function<void(const std::vector<TrialRow>&)>& show) {
  const auto start = std::chrono::steady_clock::now();
  Loop loop(configuration, driver, folder, progress);
  const ExperimentOptions& options = configuration.experiment;
  for (const std::string& warning : folder->warnings()) progress->note("warning: " + warning);
  progress->note("preset " + options.preset + ", plant " + options.plant + ", seed " +
                 std::to_string(options.seed) + ", " + std::to_string(options.trials) +
                 " trials after " + firstTrial(configuration.start));
  const int num_finished = static_cast<int>(folder->rows().size());
  show(folder->rows());
  const bool all_done = num_finished > configuration.experiment.trials;
  if (all_done) {
    progress->note("all " + std::to_string(num_finished) +
                   " trials are finished already: nothing is run");
  } else {
    if (num_finished > 0) {
      progress->note("resuming after trial " + std::to_string(num_finished - 1));
    }
    loop.resume(num_finished);
  }
  for (int trial = num_finished; trial <= configuration.experiment.trials; ++trial) {
    loop.recordTrial(trial);
    const TrainingOutcome training = loop.learn(trial);
    const TrialOutcome greedy = loop.evaluateGreedily(trial);
    folder->writeRun({trial, /*evaluation=*/true}, greedy);
    loop.finish(trial, training, greedy);
    show(folder->rows());
  }
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!all_done || !folder->confirmSummary()) folder->writeSummary(wall_s);
  progress->summary(folder->rows(), folder->path(), wall_s);
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
