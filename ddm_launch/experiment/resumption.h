// How an experiment takes up what an earlier call left, and the request and the table row of each trial.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "configuration.h"
#include "driver.h"
#include "progress.h"
#include "run_folder.h"

namespace ddm {

/// Prints the preset, the plant and the number of trials, and how many trials an earlier call has finished.
void announce(const Configuration& configuration, const RunFolder& folder, Progress* progress);

/// Gives the driver the model for a trial, which an earlier call may have begun: that of the
/// training before the trial, and for trial 0 that of `start`, if there is one.
/// @throws std::runtime_error before anything moves, if a bag that the training after the trial will
///         read is damaged
void resumeTrial(int trial, const Configuration& configuration, Driver* driver,
                 const RunFolder& folder, Progress* progress);

/// A run of a trial as the configuration has it, but greedy and not recorded.
/// @param evaluation  the greedy run after the trial
TrialRequest requestFor(const Configuration& configuration, int trial, bool evaluation);

/// The columns of a row of trials.csv that follow from the evaluation; the others keep their defaults.
/// @param plant  its goal is set to that of the evaluation
TrialRow rowOf(const TrialId& id, const TrialOutcome& greedy, const EvaluationOptions& options,
               Plant* plant);

}  // namespace ddm
