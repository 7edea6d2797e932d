// The three baselines of the paper, PILCO on three kinds of observation.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_pilco/messages.h>

#include <memory>

#include "configuration.h"
#include "method_kinds.h"
#include "observations.h"
#include "pilco_method.h"
#include "pilco_options.h"

namespace ddm {
namespace {

using MakeObservation = std::function<std::unique_ptr<Observation>(
    const Configuration&, const PilcoOptions&, const Plant&)>;

PilcoConfig readConfig(ParamReader* reader) {
  PilcoConfig config;
  config.pilco = reader->read<PilcoOptions>("pilco");
  config.gp = reader->read<pilco::GpTrainingOptions>("gp");
  config.sparse_gp = reader->read<pilco::SparseGpOptions>("sparse_gp");
  config.policy_search = reader->read<pilco::PolicySearchOptions>("policy_search");
  return config;
}

YAML::Node readBlocks(ParamReader* reader) {
  const PilcoConfig config = readConfig(reader);
  YAML::Node out;
  out["pilco"] = toYaml(config.pilco);
  out["gp"] = toYaml(config.gp);
  out["sparse_gp"] = toYaml(config.sparse_gp);
  out["policy_search"] = toYaml(config.policy_search);
  return out;
}

MethodKind pilcoKind(const std::string& name, const std::string& about,
                     const MakeObservation& make_observation) {
  const auto make = [make_observation](const Configuration& all, const Plant& plant) {
    pilco::require(
        !(all.camera.drop_rate > 0.0),
        "camera/drop_rate must be 0 with PILCO, which takes a segment of its data without "
        "a gap for a trial, got ",
        all.camera.drop_rate);
    ParamReader reader(all.method_blocks);
    const PilcoConfig config = readConfig(&reader);
    return std::make_unique<PilcoMethod>(all, config, make_observation(all, config.pilco, plant));
  };
  return {name, "PILCO on " + about, readBlocks, make};
}

}  // namespace

std::vector<MethodKind> pilcoMethods() {
  return {pilcoKind("pilco_state", "the true state",
                    [](const Configuration&, const PilcoOptions& options, const Plant& plant) {
                      return std::make_unique<TrueStateObservation>(plant, options);
                    }),
          pilcoKind("pilco_features", "features of an auto-encoder that is trained alone",
                    [](const Configuration& all, const PilcoOptions& options, const Plant&) {
                      return std::make_unique<FeatureObservation>(all.model, options);
                    }),
          pilcoKind("pilco_pca", "principal components of the image",
                    [](const Configuration& all, const PilcoOptions& options, const Plant&) {
                      return std::make_unique<PcaObservation>(all.model, options);
                    })};
}

}  // namespace ddm
