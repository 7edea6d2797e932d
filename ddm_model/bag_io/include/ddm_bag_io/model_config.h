// Everything that turns bags into a model, as it stands in YAML.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/model_options.h>
#include <ddm_params/image_options.h>
#include <ddm_params/param_reader.h>

#include <string>

#include "ddm_bag_io/bag_options.h"

namespace ddm {

/// The blocks `image`, `model`, `training` and `data_set`.
struct ModelConfig {
  ImageOptions image;
  ModelOptions model;
  TrainingOptions training;
  BagOptions data_set;
};

/// Reads the four blocks; call reader->requireValid() when all blocks are read.
ModelConfig readModelConfig(ParamReader* reader);

/// The four blocks as a YAML tree.
YAML::Node toYaml(const ModelConfig& config);

/// The four blocks as YAML text, kept in each model.
std::string toText(const ModelConfig& config);

}  // namespace ddm
