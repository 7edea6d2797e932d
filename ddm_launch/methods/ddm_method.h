// The paper's method: deep dynamical model and MPC in its feature space.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_cache.h>
#include <ddm_model/ddm.h>

#include <memory>
#include <string>
#include <vector>

#include "configuration.h"
#include "method.h"

namespace ddm {

/// Does what model_node and mpc_node do.
class DdmMethod : public Method {
 public:
  DdmMethod(const Configuration& configuration, const Plant& plant);

  /// @throws std::runtime_error if a bag cannot be read or the training comes to nothing
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override;
  std::shared_ptr<Policy> policy() const override;
  bool useModel(const std::string& path) override;

 private:
  const Configuration& configuration_;
  BagCache bags_;
  std::shared_ptr<const Ddm> model_;
};

}  // namespace ddm
