// What an experiment begins with: a saved model, bags, and what an earlier call has left.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <memory>
#include <string>

#include "configuration.h"
#include "driver.h"
#include "progress.h"
#include "run_folder.h"

namespace ddm {

/// @throws std::runtime_error with the path and the fault
std::shared_ptr<const Ddm> readModel(const std::string& path);

/// @param source  file of the model, for messages
/// @throws std::invalid_argument if model, configuration and plant or robot do not fit together
void requireModelFits(const std::shared_ptr<const Ddm>& model, const std::string& source,
                      const Configuration& configuration);

/// Completes the block `start` of a configuration: absolute paths, and checksums of the files, so
/// that nobody resumes with other files. Nothing to do where the block is empty.
/// @throws std::runtime_error if a file cannot be read
/// @throws std::invalid_argument if the method cannot start from the files, a checksum that is given
///         already is not that of its file, or model or bags do not fit configuration and plant
void prepareStart(Configuration* configuration);

/// Prints the preset, the plant and the number of trials, and how many trials an earlier call has finished.
void announce(const Configuration& configuration, const RunFolder& folder, Progress* progress);

/// Gives the driver the model for a trial, which an earlier call may have begun: that of the
/// training before the trial, and for trial 0 that of `start`, if there is one.
/// @throws std::runtime_error before anything moves, if a bag that the training after the trial will
///         read is damaged
void resumeTrial(int trial, const Configuration& configuration, Driver* driver,
                 const RunFolder& folder, Progress* progress);

}  // namespace ddm
