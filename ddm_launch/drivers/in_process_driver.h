// Everything in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/controller.h>
#include <ddm_plant_plugin/picture_message.h>
#include <ddm_sim/environment.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <memory>

#include "configuration.h"
#include "driver.h"
#include "method.h"

namespace ddm {

/// An image that was seen, and what was decided on it. The environment is where it was rendered.
struct ClosedLoopFrame {
  int index = 0;  ///< among the images seen
  sensor_msgs::Image image;
  Grey grey;  ///< of the image, as the learner gets it
  Decision decision;
};

/// The closed loop of a trial in one process: what is seen is decided on, and what is decided acts.
/// Time goes on where an image is lost. The goal is that of the trial.
/// @param policy  may be null where the trial is random
/// @param take    called for each image before its torque acts; the last torque does not act
/// @throws std::invalid_argument if the policy is null where it is needed
void runClosedLoop(Environment* environment, std::shared_ptr<Policy> policy,
                   const TrialRequest& request, const Configuration& configuration,
                   const std::function<void(const ClosedLoopFrame&)>& take);

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
