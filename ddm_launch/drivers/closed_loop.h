// The closed loop in one process: what is seen is decided on, and what is decided acts.
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

namespace ddm {

/// A frame that was seen, and what was decided on it. The environment is where it was photographed.
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
void runClosedLoop(Environment* environment, EpsilonGreedy* policy, const TrialId& id,
                   int image_size, int num_frames, const TakeFrame& take);

/// The same for a trial of an experiment, with its exploration.
/// @param policy  may be null where the trial is random
/// @throws std::invalid_argument if it is null where it is needed
void runClosedLoop(Environment* environment, std::shared_ptr<Policy> policy,
                   const TrialRequest& request, const Configuration& configuration,
                   const TakeFrame& take);

}  // namespace ddm
