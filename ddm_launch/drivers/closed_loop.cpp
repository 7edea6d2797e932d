// The closed loop in one process: what is seen is decided on, and what is decided acts.
// SPDX-License-Identifier: BSD-3-Clause
#include "closed_loop.h"

#include <ddm_common/image_codec.h>
#include <ddm_model/per_motor.h>

#include <cmath>
#include <string>
#include <utility>

namespace ddm {
namespace {

/// Stamp of a frame of a trial that begins at one second, like sim_node's first.
ros::Time stampOf(const Environment& environment) {
  const auto step_ns =
      static_cast<std::uint64_t>(std::llround(environment.plant().info().dt * 1e9));
  return ros::Time(1, 0) +
         ros::Duration().fromNSec(static_cast<std::int64_t>(environment.numSteps() * step_ns));
}

}  // namespace

void runClosedLoop(Environment* environment, EpsilonGreedy* policy, const TrialId& id,
                   int image_size, int num_frames, const TakeFrame& take) {
  Picture picture = environment->reset(id.seed, id.trial, id.evaluation);
  policy->setGoal(
      decodeImage(imageMessage(environment->goalImage(), stampOf(*environment)), image_size));
  const std::string optical_frame = opticalFrame(environment->plant().cameraModel());
  ClosedLoopFrame frame;
  for (frame.index = 0; frame.index < num_frames; ++frame.index) {
    if (frame.index > 0) {
      const std::uint64_t steps = environment->numSteps();
      picture = environment->stepUntilSeen(frame.decision.torque);
      if (environment->numSteps() > steps + 1) policy->startSegment();  // the camera lost a frame
    }
    frame.image = imageMessage(picture, stampOf(*environment), optical_frame);
    frame.grey = decodeImage(frame.image, image_size);
    frame.decision = policy->decide(frame.grey);
    take(frame);
  }
}

void runClosedLoop(Environment* environment, std::shared_ptr<Policy> policy,
                   const TrialRequest& request, const Configuration& configuration,
                   const TakeFrame& take) {
  EpsilonGreedy::Options options;
  options.epsilon = request.epsilon;
  options.hold_steps = request.hold_steps;
  options.max_torque =
      perMotor(configuration.mpc.max_torque, environment->plant().torqueDim(), "mpc/max_torque");
  EpsilonGreedy explorer(request.epsilon < 1.0 ? std::move(policy) : nullptr, options, request.id);
  runClosedLoop(environment, &explorer, request.id, configuration.model.image.size,
                request.num_steps, take);
}

}  // namespace ddm
