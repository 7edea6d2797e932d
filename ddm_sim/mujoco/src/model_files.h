// Finds, reads and compiles the files that belong to a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {

/// The text of a model and the files that it uses.
struct ModelText {
  std::string path;  ///< path of the model file; MuJoCo searches other files from its folder
  std::string text;  ///< MJCF or URDF
  /// Pairs of a mesh's name in the text and its file.
  std::vector<std::pair<std::string, std::string>> meshes;
};

using ModelPointer = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using DataPointer = std::unique_ptr<mjData, void (*)(mjData*)>;

struct ModelFiles {
  std::string digest;   ///< checksum over all files: "crc32-" and eight hexadecimal digits
  std::string missing;  ///< names of the files that do not exist, separated by commas
};

/// Reads a model file and all files that it names: includes, meshes, textures.
/// @throws std::exception with the path if a file cannot be read or has the wrong content
ModelFiles filesOf(const ModelText& model, const FindPackage& find_package);

/// Reads MJCF and makes the text that MuJoCo gets.
/// @throws std::invalid_argument as resolved()
ModelText readMjcf(const std::string& text, const std::string& path,
                   const FindPackage& find_package);

/// Two coupled joints (<mimic>):
///
///   q_follower = multiplier q_leader + offset
struct Coupling {
  std::string follower;
  std::string leader;
  double multiplier = 1.0;
  double offset = 0.0;
};

struct Urdf {
  ModelText model;
  UrdfFacts facts;
  std::vector<Coupling> couplings;  ///< from the <mimic> elements
  bool contacts = false;            ///< true: a <mujoco> block asks for contacts
};

/// Checks a URDF file and rewrites the parts that MuJoCo would misread.
/// @param path  path of the file; relative names count from its folder
/// @throws std::invalid_argument naming element, value, rule and remedy
Urdf readUrdf(const std::string& text, const std::string& path, const FindPackage& find_package);

/// Path of package://PACKAGE/PATH or file://PATH. Returns other names unchanged.
/// @throws std::invalid_argument with the name and the remedy if the package cannot be found
std::string resolved(const std::string& name, const FindPackage& find_package);

/// Remedy for an error with which MuJoCo has refused a model. Empty if no remedy is known.
std::string hintFor(const std::string& error);

/// Content of the whole file.
/// @throws std::invalid_argument with the path if it cannot be read
std::string readModelFile(const std::string& path);

/// Compiles a model. Before that, a child process compiles the model, simulates a few physics steps
/// and updates the scene, because MuJoCo may crash, hang or fill the memory.
/// @throws std::invalid_argument with MuJoCo's reason, or with the way in which the child process
///         ended, or naming an array that has a number that is not finite
/// @throws std::runtime_error if the child process cannot be started
ModelPointer loadModel(const ModelText& model);

/// Memory for the simulation of a model.
/// @throws std::invalid_argument if there is not enough memory
DataPointer makeData(const mjModel& model);

}  // namespace ddm
