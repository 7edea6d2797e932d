// Prepares the model and the data that an experiment, or a resumed experiment, starts from.
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

/// @throws std::runtime_error with path and reason if the file is not a valid model
std::shared_ptr<const Ddm> readModel(const std::string& path);

/// Checks that a saved model fits the configuration.
/// @param source  path of the model, for error messages
/// @throws std::invalid_argument if model, configuration and plant or robot do not fit together
void requireModelFits(const std::shared_ptr<const Ddm>& model, const std::string& source,
                      const Configuration& configuration);

/// Completes the block `start`: makes its paths absolute and adds the checksum of each file, so
/// that an experiment cannot be resumed with other files. Does nothing if the block is empty.
/// @throws std::runtime_error if a file cannot be read
/// @throws std::invalid_argument if the method cannot start from files, if a given checksum differs
///         from that of its file, or if model or bags do not fit configuration and plant
void prepareStart(Configuration* configuration);

/// Prints preset, plant, seed and number of trials, and how many trials are finished already.
void announce(const Configuration& configuration, const RunFolder& folder, Progress* progress);

/// Gives the driver the model to explore with in a trial, which an earlier call may have begun. The
/// model is that of the previous training; for trial 0 it is that of `start`, if there is one.
/// @throws std::runtime_error before anything moves, if one of the bags for the next training is
///         damaged
void resumeTrial(int trial, const Configuration& configuration, Driver* driver,
                 const RunFolder& folder, Progress* progress);

}  // namespace ddm
