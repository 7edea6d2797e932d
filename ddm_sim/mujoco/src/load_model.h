// Compiles a model, after a separate process has tried it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

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
