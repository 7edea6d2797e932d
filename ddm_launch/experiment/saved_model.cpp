// A model from a file in the place of a method: it acts, and learns nothing.
// SPDX-License-Identifier: BSD-3-Clause
#include "saved_model.h"

#include <ddm_files/plain_file.h>
#include <ddm_model/model_file.h>
#include <ddm_mpc/mpc_policy.h>

#include <stdexcept>

namespace ddm {
namespace {

class SavedModelMethod : public Method {
 public:
  explicit SavedModelMethod(std::shared_ptr<Policy> policy) : policy_(std::move(policy)) {}

  TrainingOutcome train(const std::vector<std::string>& /*bags*/, const TrialId& /*id*/,
                        const PhaseCallback& /*progress*/) override {
    throw std::logic_error("a saved model learns nothing");
  }
  std::shared_ptr<Policy> policy() const override { return policy_; }

 private:
  std::shared_ptr<Policy> policy_;
};

}  // namespace

std::shared_ptr<const Ddm> readModel(const std::string& path) {
  return std::make_shared<const Ddm>(deserialiseModel(readFile(path), path));
}

std::shared_ptr<Policy> makeModelPolicy(std::shared_ptr<const Ddm> model, const std::string& source,
                                        const Configuration& configuration, const Plant& plant) {
  const auto fail = [&source](const std::string& what, int ours, const std::string& of, int theirs,
                              const std::string& remedy) {
    throw std::invalid_argument("model " + source + " has " + what + " " + std::to_string(ours) +
                                ", " + of + " " + std::to_string(theirs) + ": " + remedy);
  };
  if (model->imageSize() != configuration.model.image.size) {
    fail("images of size", model->imageSize(), "image/size is", configuration.model.image.size,
         "set image/size to the model's");
  }
  if (model->torqueDim() != plant.torqueDim()) {
    fail("a number of torques of", model->torqueDim(), "the plant", plant.torqueDim(),
         "choose the plant that it was trained on");
  }
  try {
    return std::make_shared<MpcPolicy>(std::move(model), configuration.mpc);
  } catch (const std::invalid_argument& e) {
    throw std::invalid_argument("model " + source + ": " + e.what());
  }
}

std::unique_ptr<Method> SavedModelSetup::make(const Configuration& configuration,
                                              const Plant& plant) const {
  return std::make_unique<SavedModelMethod>(makeModelPolicy(model_, source_, configuration, plant));
}

}  // namespace ddm
