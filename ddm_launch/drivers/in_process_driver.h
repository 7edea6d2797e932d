// Everything in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/environment.h>

#include <memory>

#include "configuration.h"
#include "driver.h"
#include "method.h"

namespace ddm {

/// With the method `ddm` it does what the nodes do in lock-step, with the same cores and the same
/// bags in between: the same configuration and seed give the same torques.
class InProcessDriver : public Driver {
 public:
  /// @param configuration  with a method; outlives the driver
  /// @throws std::invalid_argument if the configuration asks for real time, or does not fit the
  /// method
  explicit InProcessDriver(const Configuration& configuration);

  TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) override;
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override {
    return method_->train(bags, id, progress);
  }
  bool useModel(const std::string& path) override { return method_->useModel(path); }
  bool resume(const std::string& folder, const std::vector<std::string>& bags,
              const TrialId& id) override {
    return method_->resume(folder, bags, id);
  }

 private:
  const Configuration& configuration_;
  Environment environment_;
  std::unique_ptr<Method> method_;
};

}  // namespace ddm
