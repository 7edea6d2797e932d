// The closed loop in one process: what is seen is decided on, and what is decided acts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/epsilon_greedy.h>
#include <ddm_plant_plugin/picture_message.h>
#include <ddm_sim/rig.h>
#include <sensor_msgs/Image.h>

#include <functional>

namespace ddm {

/// A frame that was seen, and what was decided on it. The rig is where it was photographed.
struct ClosedLoopFrame {
  int index = 0;  ///< among the frames seen
  sensor_msgs::Image image;
  Grey grey;  ///< of the image, as the learner gets it
  Decision decision;
};

/// Runs `num_frames` frames from the start of the run `id` on, towards the goal of that run. Time
/// goes on where a frame is lost.
/// @param image_size  `image/size` [pixels]
/// @param take        called for each frame before its torque acts; the last torque does not act
void runClosedLoop(Rig* rig, EpsilonGreedy* policy, const TrialId& id, int image_size,
                   int num_frames, const std::function<void(const ClosedLoopFrame&)>& take);

}  // namespace ddm
