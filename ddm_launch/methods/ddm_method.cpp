// The paper's method: a deep dynamical model and MPC in its feature space.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_cache.h>
#include <ddm_model/model_file.h>
#include <ddm_model/trainer.h>
#include <ddm_mpc/controller.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "method.h"
#include "start.h"

namespace ddm {
namespace {

/// Trains and plans with the same code as model_node and mpc_node.
class DdmMethod : public Method {
 public:
  explicit DdmMethod(const Configuration& configuration)
      : configuration_(configuration),
        bags_(configuration.model.image.size, configuration.model.data_set) {
    requireLearnedPrediction(configuration.model.training);
  }

  /// @throws std::runtime_error if a bag cannot be read or the training fails
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override {
    ModelInfo info;
    info.seed = id.seed;
    info.trial = id.trial;
    info.config = toText(configuration_.model);
    const TrainingResult result =
        ddm::train(bags_.read(bags), configuration_.model.model, configuration_.model.training,
                   info, [&progress](const TrainingProgress& state) {
                     progress(state.fraction_done);
                     return true;
                   });
    if (!result.model) throw std::runtime_error(result.message);
    setModel(std::make_shared<const Ddm>(*result.model));
    TrainingOutcome outcome;
    outcome.files["model.ddm"] = serialiseModel(*model_);
    outcome.frames = model_->info().frames;
    outcome.v_r = model_->info().v_r;
    outcome.v_p = model_->info().v_p;
    outcome.seconds = result.seconds;
    outcome.evaluations = result.evaluations;
    return outcome;
  }

  std::shared_ptr<Policy> policy() const override {
    if (policy_ == nullptr && model_ != nullptr) {
      policy_ = std::make_shared<MpcPolicy>(model_, configuration_.mpc);
    }
    return policy_;
  }

  bool useModel(const std::string& path) override {
    setModel(readModel(path));
    return true;
  }

 private:
  void setModel(std::shared_ptr<const Ddm> model) {
    model_ = std::move(model);
    policy_.reset();
  }

  const Configuration& configuration_;
  BagCache bags_;
  std::shared_ptr<const Ddm> model_;
  // All trials of a model share its policy, because the cost-to-go takes up to two seconds.
  mutable std::shared_ptr<Policy> policy_;
};

}  // namespace

std::unique_ptr<Method> makeDdmMethod(const Configuration& configuration, const Plant& /*plant*/) {
  return std::make_unique<DdmMethod>(configuration);
}

}  // namespace ddm
