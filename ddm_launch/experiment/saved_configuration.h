// config.yaml of a folder of results, compared with what is to run there.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// The differences with which an experiment must not go on, a line each; empty: none. What is
/// chosen by looking at the robot (crop and goal) may change until the first trial is finished.
/// @param there  blocks by name, with today's keys; anything that is not a block is left out
/// @param here   likewise
std::string differencesOf(const YAML::Node& there, const YAML::Node& here, bool trial_finished);

}  // namespace ddm
