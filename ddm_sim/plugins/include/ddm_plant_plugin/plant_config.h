// Reads the block `plant` of a configuration, and finds the file that describes a plant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>

#include <memory>
#include <string>
#include <vector>

#include "ddm_plant_plugin/plant_plugin.h"

namespace ddm {

/// Reads the block `plant`. The key `type` (default: pendulum) names the plant. PACKAGE/CLASS names
/// a plugin of another package, which is loaded and stays loaded until the program ends.
/// @throws std::invalid_argument with the available plants if there is no such plant
/// @throws std::runtime_error if the library of the plugin cannot be loaded
std::shared_ptr<const PlantPlugin> readPlant(ParamReader* reader);

/// Reads the plant from configuration files, which are merged with ddm_sim's defaults; later files
/// replace values of earlier files.
/// @throws std::exception with the problems of the files, or as readPlant()
std::shared_ptr<const PlantPlugin> readPlantFiles(std::vector<std::string> files);

/// Names of the plants that the folder config/ of a package describes, sorted.
/// @throws std::invalid_argument if the package cannot be found
std::vector<std::string> plantsOf(const std::string& package);

/// Whether the name of a plant is the path of its file, and not a name within a package.
bool namesPlantFile(const std::string& name);

/// Returns the path of the file that describes a plant: config/NAME.yaml of ddm_sim; for
/// PACKAGE/NAME, config/NAME.yaml of that package; or the name itself if it is the path of an
/// existing .yaml file.
/// @throws std::invalid_argument with the available plants or the remedy if there is no such file or
///         package, or if the name is that of a model file
std::string plantFile(const std::string& name);

}  // namespace ddm
