// What an experiment starts from instead of nothing: a saved model, and bags.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <memory>
#include <string>

#include "configuration.h"

namespace ddm {

/// @throws std::runtime_error with the path and the fault
std::shared_ptr<const Ddm> readModel(const std::string& path);

/// @param source  file of the model, for messages
/// @throws std::invalid_argument if model, configuration and plant or robot do not fit together
void requireModelFits(const std::shared_ptr<const Ddm>& model, const std::string& source,
                      const Configuration& configuration);

/// Completes the block `start` of a configuration: absolute paths, and ids of the files' contents,
/// so that nobody resumes with other files. Nothing to do where it is empty.
/// @throws std::runtime_error if a file cannot be read
/// @throws std::invalid_argument if the method cannot start from them, an id that is given already
///         is not that of the file, or model or bags do not fit the configuration and its plant
void prepareStart(Configuration* configuration);

}  // namespace ddm
