// Everything that turns bags into a model, as it stands in YAML.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/model_config.h"

namespace ddm {

ModelConfig readModelConfig(ParamReader* reader) {
  ModelConfig config;
  config.image = reader->read<ImageOptions>("image");
  config.model = reader->read<ModelOptions>("model");
  config.training = reader->read<TrainingOptions>("training");
  config.data_set = reader->read<BagOptions>("data_set");
  return config;
}

YAML::Node toYaml(const ModelConfig& config) {
  YAML::Node out(YAML::NodeType::Map);
  out["image"] = toYaml(config.image);
  out["model"] = toYaml(config.model);
  out["training"] = toYaml(config.training);
  out["data_set"] = toYaml(config.data_set);
  return out;
}

std::string toText(const ModelConfig& config) { return YAML::Dump(toYaml(config)) + "\n"; }

}  // namespace ddm
