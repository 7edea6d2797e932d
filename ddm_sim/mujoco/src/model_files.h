// The files that make up a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ddm_mujoco/mujoco_model.h"
#include "load_model.h"

namespace ddm {

struct ModelFiles {
  std::string digest;   ///< checksum over all of them: "crc32-" and eight hexadecimal digits
  std::string missing;  ///< names of those that are not there, with commas between them
};

/// A model file and all files that it names: includes, meshes, textures.
/// @throws std::exception with the path if one of them cannot be read or is not what it should be
ModelFiles filesOf(const ModelText& model, const FindPackage& find_package);

/// MJCF as MuJoCo is given it.
/// @throws std::invalid_argument as resolved()
ModelText readMjcf(const std::string& text, const std::string& path,
                   const FindPackage& find_package);

/// The path of package://PACKAGE/PATH and file://PATH; others as they are.
/// @throws std::invalid_argument with the name and what helps, if the package cannot be found
std::string resolved(const std::string& name, const FindPackage& find_package);

/// What helps if MuJoCo has refused a model with this error; empty if no remedy is known.
std::string hintFor(const std::string& error);

}  // namespace ddm
