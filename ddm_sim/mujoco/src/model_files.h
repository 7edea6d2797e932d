// The files that make up a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {

/// The whole file.
/// @throws std::invalid_argument with the path if it cannot be read
std::string readModelFile(const std::string& path);

struct ModelFiles {
  std::string digest;   ///< checksum over all of them: "crc32-" and eight hexadecimal digits
  std::string missing;  ///< names of those that are not there, after commas
};

/// A model file and all files that it names: includes, meshes, textures.
/// @throws std::invalid_argument as readModelFile(), for one of them
ModelFiles filesOf(const std::string& path, const FindPackage& find_package);

/// A digest that covers more files, such as pictures that a configuration names.
/// @return the digest itself where there are none
/// @throws std::invalid_argument as readModelFile(), for one of them
std::string digestWith(const std::string& digest, const std::vector<std::string>& paths);

}  // namespace ddm
