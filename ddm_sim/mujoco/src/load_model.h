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

/// The whole file.
/// @throws std::invalid_argument with the path if it cannot be read
std::string readModelFile(const std::string& path);

/// @throws std::invalid_argument with MuJoCo's reason
/// @throws std::runtime_error with an error that MuJoCo does not survive by itself
std::unique_ptr<mjModel, void (*)(mjModel*)> compile(const ModelText& model);

/// Compiles a model, moves it by a few frames and updates its scene, in this process.
/// @throws std::invalid_argument with MuJoCo's reason, or naming an array with a number that is not
///         finite
void tryHere(const ModelText& model);

/// As tryHere(), in a process of its own. MuJoCo may crash, hang or fill the memory there.
/// @throws std::invalid_argument with the reason, or with what became of that process
/// @throws std::runtime_error if there can be no other process
void tryInOwnProcess(const ModelText& model);

}  // namespace ddm
