// Driver that runs plant, recorder and learner in one process, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/controller.h>
#include <ddm_plant_plugin/image_message.h>
#include <ddm_sim/environment.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <memory>

#include "configuration.h"
#include "driver.h"
#include "method.h"

namespace ddm {

/// Runs the closed loop of one episode: the policy decides on each image, and its torque acts until
/// the next image. If an image is lost, the torque acts for another time step. The goal is that of
/// the trial.
/// @param policy  may be null if all torques are random
/// @param take    called for each image and the decision on it, before its torque acts. The
///                environment is then in the state that the image shows. The last torque never acts
/// @throws std::invalid_argument if the policy is null but needed
void runClosedLoop(Environment* environment, std::shared_ptr<Policy> policy,
                   const TrialRequest& request, const Configuration& configuration,
                   const std::function<void(const sensor_msgs::Image&, const Decision&)>& take);

/// With the method `ddm`, this driver does the same as the nodes do in lock-step, with the same
/// code and the same bags. The same configuration and seed therefore give the same torques.
class InProcessDriver : public Driver {
 public:
  /// @param configuration  configuration read by readWithMethod(); must outlive the driver
  /// @throws std::invalid_argument if the configuration asks for real time or does not fit the
  ///         method
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
