// Compiles a model, and tries it in a process of its own first.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ddm {

/// A model as MuJoCo is given it.
struct ModelText {
  std::string path;  ///< of the model file, from whose folder MuJoCo finds others
  std::string text;  ///< MJCF or URDF
  std::vector<std::pair<std::string, std::string>> meshes;  ///< name in the text, and its file
};

using ModelPointer = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using DataPointer = std::unique_ptr<mjData, void (*)(mjData*)>;

/// The whole file.
/// @throws std::invalid_argument with the path if it cannot be read
std::string readModelFile(const std::string& path);

/// Compiles a model, after a process of its own has compiled it, moved it by a few frames and
/// updated its scene: MuJoCo may crash, hang or fill the memory there.
/// @throws std::invalid_argument with MuJoCo's reason, or with what became of that process, or naming
///         an array with a number that is not finite
/// @throws std::runtime_error if there can be no other process
ModelPointer loadModel(const ModelText& model);

/// The workspace in which a model moves.
/// @throws std::invalid_argument if there is not enough memory
DataPointer makeData(const mjModel& model);

}  // namespace ddm
