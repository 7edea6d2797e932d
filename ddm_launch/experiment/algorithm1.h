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

/// Follow a random control strategy and record; then, trial by trial: train on everything recorded,
/// evaluate greedily, run an epsilon-greedy trial and record (paper, Alg. 1).
///
/// Where the configuration has a start, its bags are trials before the first one, and that one is
/// epsilon-greedy, not random: with the model of the start, else with one trained on its bags.
///
/// Resumes where an earlier call on the folder ended, however it ended. A complete recording is never
/// repeated, and a training whose files are there is not either; a model that cannot be saved is
/// trained again from the bags, with the same result. If all trials are finished already, only the
/// time of the verdict changes.
/// @param show  called with the rows of all finished trials, at the start and after each trial
/// @throws std::runtime_error with what failed; all finished trials are kept
void runExperiment(
    const Configuration& configuration, Driver* driver, RunFolder* folder, Progress* progress,
    const std::function<void(const std::vector<TrialRow>&)>& show = [](const auto&) {});

}  // namespace ddm
