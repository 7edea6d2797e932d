// Everything in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/epsilon_greedy.h>
#include <ddm_plant_plugin/picture_message.h>
#include <ddm_sim/rig.h>
#include <sensor_msgs/Image.h>

#include <functional>
#include <memory>

#include "configuration.h"
#include "driver.h"
#include "method_kinds.h"

namespace ddm {

/// A frame that was seen, and what was decided on it. The rig is where it was photographed.
struct ClosedLoopFrame {
  int index = 0;  ///< among the frames seen
  sensor_msgs::Image image;
  Grey grey;  ///< of the image, as the learner gets it
  Decision decision;
};

using TakeFrame = std::function<void(const ClosedLoopFrame&)>;

/// Runs `num_frames` frames from the start of the run `id` on, towards the goal of that run. Time
/// goes on where a frame is lost.
/// @param image_size  `image/size` [pixels]
/// @param take        called for each frame before its torque acts; the last torque does not act
void runClosedLoop(Rig* rig, EpsilonGreedy* policy, const TrialId& id, int image_size,
                   int num_frames, const TakeFrame& take);

/// The same for a trial of an experiment, with its exploration.
/// @param policy  may be null where the trial is random
/// @throws std::invalid_argument if it is null where it is needed
void runClosedLoop(Rig* rig, std::shared_ptr<Policy> policy, const TrialRequest& request,
                   const Configuration& configuration, const TakeFrame& take);

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

 private:
  const Configuration& configuration_;
  Rig rig_;
  std::unique_ptr<Method> method_;
};

}  // namespace ddm
