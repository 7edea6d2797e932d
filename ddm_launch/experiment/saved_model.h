// A model from a file in the place of a method: it acts, and learns nothing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <memory>
#include <string>

#include "configuration.h"
#include "method.h"

namespace ddm {

/// @throws std::runtime_error with the path and the fault
std::shared_ptr<const Ddm> readModel(const std::string& path);

/// The policy that plans with a model on this plant.
/// @param source  file of the model, for messages
/// @throws std::invalid_argument if model, configuration and plant do not fit together
std::shared_ptr<Policy> makeModelPolicy(std::shared_ptr<const Ddm> model, const std::string& source,
                                        const Configuration& configuration, const Plant& plant);

/// The method that acts by a saved model. Its train() is an error.
class SavedModelSetup : public MethodSetup {
 public:
  /// @param source  file of the model, for messages
  SavedModelSetup(std::shared_ptr<const Ddm> model, std::string source)
      : model_(std::move(model)), source_(std::move(source)) {}

  YAML::Node blocks() const override { return YAML::Node(YAML::NodeType::Map); }
  std::unique_ptr<Method> make(const Configuration& configuration,
                               const Plant& plant) const override;

 private:
  std::shared_ptr<const Ddm> model_;
  std::string source_;
};

}  // namespace ddm
