// The parameters that determine how bags become a model, and their YAML form.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/image_options.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/param_reader.h>
#include <ddm_model/model_options.h>

#include <string>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// The blocks `image`, `model`, `training` and `data_set`.
struct ModelConfig {
  ImageOptions image;
  ModelOptions model;
  TrainingOptions training;
  BagOptions data_set;
};

/// Reads the four blocks. Call reader->requireValid() after all blocks are read.
inline ModelConfig readModelConfig(ParamReader* reader) {
  ModelConfig config;
  config.image = reader->read<ImageOptions>("image");
  config.model = reader->read<ModelOptions>("model");
  config.training = reader->read<TrainingOptions>("training");
  config.data_set = reader->read<BagOptions>("data_set");
  return config;
}

/// The four blocks as a YAML tree.
inline YAML::Node toYaml(const ModelConfig& config) {
  YAML::Node out(YAML::NodeType::Map);
  out["image"] = toYaml(config.image);
  out["model"] = toYaml(config.model);
  out["training"] = toYaml(config.training);
  out["data_set"] = toYaml(config.data_set);
  return out;
}

/// The four blocks as YAML text, which each model contains.
inline std::string toText(const ModelConfig& config) { return YAML::Dump(toYaml(config)) + "\n"; }

}  // namespace ddm
