// The files that make up a model. And what MuJoCo has to be told to take URDF as its author meant it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
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

/// Whether the text of a model file is URDF.
bool isUrdf(const std::string& text);

/// Whether a <mujoco> block of its own says how to take it.
bool hasMujocoBlock(const std::string& text);

/// With its visual shapes, and with mesh names that keep their folders; a <mujoco> block of its own
/// stays as it is.
std::string urdfForMujoco(const std::string& text);

/// What helps where MuJoCo has refused a file; empty if nothing is known to.
std::string hintFor(const std::string& text, const std::string& error);

/// `effort` of the <limit> of each joint that has one [N m or N]; MuJoCo 2.2 does not read it.
/// @throws std::invalid_argument if it is not XML
std::map<std::string, double> effortLimits(const std::string& text);

/// With all package://PACKAGE/ replaced by folders.
/// @throws std::invalid_argument naming the package that cannot be found
std::string withoutPackageUris(std::string text, const FindPackage& find_package);

}  // namespace ddm
