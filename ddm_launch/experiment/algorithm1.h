// Algorithm 1 of the paper: adaptive MPC in feature space, with either driver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "configuration.h"
#include "driver.h"
#include "progress.h"
#include "run_folder.h"

namespace ddm {

/// Runs Algorithm 1 of the paper. Records one trial with random torques. Then repeats three steps:
/// trains on all data recorded so far, runs a greedy evaluation, records an epsilon-greedy trial.
///
/// If the configuration has a block `start`, its bags count as trials before trial 0, and trial 0
/// is epsilon-greedy instead of random. The model of trial 0 is that of `start`, or one trained on
/// the bags of `start`.
///
/// The function resumes an experiment that an earlier call began, even if that call was killed.
/// Complete recordings and trainings are never repeated. The exception is a model that cannot be
/// saved: it is trained again from the bags, with the same result. If all trials are finished
/// already, only the modification time of summary.yaml changes.
/// @param show  receives the rows of all finished trials at the start and after each trial
/// @throws std::runtime_error naming the failure; all finished trials are kept
void runExperiment(
    const Configuration& configuration, Driver* driver, RunFolder* folder, Progress* progress,
    const std::function<void(const std::vector<TrialRow>&)>& show = [](const auto&) {});

}  // namespace ddm
