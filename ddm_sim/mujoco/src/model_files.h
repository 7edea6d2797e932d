// The files that make up a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "load_model.h"

namespace tinyxml2 {
class XMLElement;
}

namespace ddm {

struct ModelFiles {
  std::string digest;   ///< checksum over all of them: "crc32-" and eight hexadecimal digits
  std::string missing;  ///< names of those that are not there, after commas
};

/// A model file and all files that it names: includes, meshes, textures.
/// @throws std::invalid_argument as readModelFile(), for one of them
ModelFiles filesOf(const ModelText& model, const FindPackage& find_package);

/// The name of the outermost element, in lower case: "mujoco" (MJCF), "robot" (URDF).
/// @throws std::invalid_argument with the line if the text is not XML
std::string rootOf(const std::string& text);

/// MJCF as MuJoCo is given it.
/// @throws std::invalid_argument as resolved()
ModelText readMjcf(const std::string& text, const std::string& path,
                   const FindPackage& find_package);

/// The path of package://PACKAGE/PATH and file://PATH; others as they are.
/// @throws std::invalid_argument with the name and what helps, if the package cannot be found
std::string resolved(const std::string& name, const FindPackage& find_package);

/// Whether MuJoCo reads this kind of mesh, by the end of its name.
bool isMeshKind(const std::string& file);

/// @param named  the file as the model has it, for the message
/// @throws std::invalid_argument naming the file and what helps, if there is no such mesh
void requireMesh(const tinyxml2::XMLElement& element, const std::string& named,
                 const std::string& file);

/// What helps where MuJoCo has refused a model; empty if nothing is known to.
std::string hintFor(const std::string& error);

}  // namespace ddm
