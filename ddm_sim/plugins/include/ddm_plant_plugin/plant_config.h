// The block `plant` of any plant, ours or another package's, and the file that describes it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_params/param_reader.h>
#include <ddm_sim/plant_options.h>

#include <string>

namespace ddm {

/// Reads the block `plant`. A `plant/type` with a slash names a plugin (PACKAGE/CLASS), which is
/// loaded and reads the block; it stays loaded until the program ends.
/// @throws std::invalid_argument naming what there is, if there is no such plugin
/// @throws std::runtime_error if its library cannot be loaded
PlantOptions readPlant(ParamReader* reader);

/// Effective values of the block that readPlant() read.
YAML::Node plantBlock(const PlantOptions& plant);

/// The file that describes a plant: config/NAME.yaml of ddm_sim, for PACKAGE/NAME of that package.
/// @throws std::invalid_argument naming what there is, if there is no such file or package
std::string plantFile(const std::string& name);

}  // namespace ddm
