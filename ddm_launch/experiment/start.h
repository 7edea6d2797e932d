// What an experiment starts from instead of nothing: a saved model, and bags.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "configuration.h"

namespace ddm {

/// Completes the block `start` of a configuration: absolute paths, and ids of the files' contents,
/// so that nobody resumes with other files. Nothing to do where it is empty.
/// @throws std::runtime_error if a file cannot be read
/// @throws std::invalid_argument if the method cannot start from them, an id that is given already
///         is not that of the file, or model or bags do not fit the configuration and its plant
void prepareStart(Configuration* configuration);

}  // namespace ddm
