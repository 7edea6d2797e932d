// The three baselines of the paper, PILCO on three kinds of observation.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco_methods.h"

#include <ddm_params/param_value.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "configuration.h"
#include "feature_observation.h"
#include "pca_observation.h"
#include "pilco_method.h"
#include "true_state_observation.h"

namespace ddm {
namespace {

using MakeObservation = std::function<std::unique_ptr<Observation>(
    const Configuration&, const PilcoOptions&, const Plant&)>;

class PilcoSetup : public MethodSetup {
 public:
  PilcoSetup(const PilcoConfig& config, MakeObservation make_observation)
      : config_(config), make_observation_(std::move(make_observation)) {}

  YAML::Node blocks() const override {
    YAML::Node out(YAML::NodeType::Map);
    out["pilco"] = toYaml(config_.pilco);
    out["gp"] = toYaml(config_.gp);
    out["sparse_gp"] = toYaml(config_.sparse_gp);
    out["policy_search"] = toYaml(config_.policy_search);
    return out;
  }

  std::unique_ptr<Method> make(const Configuration& configuration,
                               const Plant& plant) const override {
    const double drop_rate = configuration.camera.drop_rate;
    if (drop_rate > 0.0) {
      throw std::invalid_argument(
          "camera/drop_rate must be 0 with PILCO, which takes a piece of its data without a gap "
          "for a trial, got " +
          formatDouble(drop_rate));
    }
    return std::make_unique<PilcoMethod>(configuration, config_,
                                         make_observation_(configuration, config_.pilco, plant));
  }

 private:
  PilcoConfig config_;
  MakeObservation make_observation_;
};

MethodKind pilcoKind(const std::string& name, const std::string& about,
                     const MakeObservation& make_observation) {
  return {name, "PILCO on " + about, [make_observation](ParamReader* reader) {
            PilcoConfig config;
            config.pilco = reader->read<PilcoOptions>("pilco");
            config.gp = reader->read<pilco::GpTrainingOptions>("gp");
            config.sparse_gp = reader->read<pilco::SparseGpOptions>("sparse_gp");
            config.policy_search = reader->read<pilco::PolicySearchOptions>("policy_search");
            return std::make_shared<PilcoSetup>(config, make_observation);
          }};
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
