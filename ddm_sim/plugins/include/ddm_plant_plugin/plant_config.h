// The block `plant` of any plant, ours or another package's, and the file that describes it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>

#include <memory>
#include <string>
#include <vector>

#include "ddm_plant_plugin/plant_plugin.h"

namespace ddm {

/// Reads the block `plant`. Its key `type` (default: pendulum) names the plant; with a slash it is
/// PACKAGE/CLASS of another package, which is loaded and stays loaded until the program ends.
/// @throws std::invalid_argument naming what there is, if there is no such plant
/// @throws std::runtime_error if its library cannot be loaded
std::shared_ptr<const PlantPlugin> readPlant(ParamReader* reader);

/// The plant that configuration files describe on top of ddm_sim's defaults; later files win.
/// @throws std::exception with what is wrong with them, or as above
std::shared_ptr<const PlantPlugin> readPlantFiles(std::vector<std::string> files);

/// Whether a plant is named by its file, not by a name in a package.
bool namesPlantFile(const std::string& name);

/// The file that describes a plant: config/NAME.yaml of ddm_sim, for PACKAGE/NAME of that package,
/// or the file itself, if the name ends in .yaml and there is one.
/// @throws std::invalid_argument naming what there is, if there is no such file or package
std::string plantFile(const std::string& name);

}  // namespace ddm
