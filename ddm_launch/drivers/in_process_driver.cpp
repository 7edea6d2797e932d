// Everything in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_driver.h"

#include <ddm_bag_io/bag_writer.h>
#include <ddm_images/image_codec.h>
#include <ddm_model/per_motor.h>
#include <ddm_msgs/Torque.h>
#include <ddm_sim/plant_factory.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "method_kinds.h"

namespace ddm {
namespace {

/// Stamp of a frame of a trial that begins at one second, like sim_node's first.
ros::Time stampOf(const Rig& rig) {
  const auto step_ns = static_cast<std::uint64_t>(std::llround(rig.plant().info().dt * 1e9));
  return ros::Time(1, 0) +
         ros::Duration().fromNSec(static_cast<std::int64_t>(rig.numSteps() * step_ns));
}

/// An image and the torque that answers it.
void write(const sensor_msgs::Image& image, const Decision& decision, BagWriter* bag) {
  ddm_msgs::Torque torque;
  torque.header.stamp = image.header.stamp;
  torque.torque.assign(decision.torque.data(), decision.torque.data() + decision.torque.size());
  torque.exploratory = decision.exploratory;
  bag->write(image);
  bag->write(torque);
}

}  // namespace

void runClosedLoop(Rig* rig, EpsilonGreedy* policy, const TrialId& id, int image_size,
                   int num_frames, const TakeFrame& take) {
  Picture picture = rig->reset(id.seed, id.trial, id.evaluation);
  policy->setGoal(decodeImage(imageMessage(rig->goalImage(), stampOf(*rig)), image_size));
  const std::string optical_frame = opticalFrame(rig->plant().cameraModel());
  ClosedLoopFrame frame;
  for (frame.index = 0; frame.index < num_frames; ++frame.index) {
    if (frame.index > 0) picture = rig->stepUntilSeen(frame.decision.torque);
    frame.image = imageMessage(picture, stampOf(*rig), optical_frame);
    frame.grey = decodeImage(frame.image, image_size);
    frame.decision = policy->decide(frame.grey);
    take(frame);
  }
}

void runClosedLoop(Rig* rig, std::shared_ptr<Policy> policy, const TrialRequest& request,
                   const Configuration& configuration, const TakeFrame& take) {
  EpsilonGreedy::Options options;
  options.epsilon = request.epsilon;
  options.bang_bang = configuration.mpc.exploration == "bang_bang";
  options.hold_steps = request.hold_steps;
  options.max_torque =
      perMotor(configuration.mpc.max_torque, rig->plant().torqueDim(), "mpc/max_torque");
  EpsilonGreedy explorer(request.epsilon < 1.0 ? std::move(policy) : nullptr, options, request.id);
  runClosedLoop(rig, &explorer, request.id, configuration.model.image.size, request.num_steps,
                take);
}

InProcessDriver::InProcessDriver(const Configuration& configuration)
    : configuration_(configuration),
      rig_(makePlant(*configuration.plant), configuration.camera),
      method_(methodKind(configuration.experiment.method).make(configuration, rig_.plant())) {
  if (!configuration.sim.lockstep) {
    throw std::invalid_argument(
        "sim/lockstep must be true where everything runs in one process: use experiment.launch for "
        "real time");
  }
}

TrialOutcome InProcessDriver::runTrial(const TrialRequest& request, const PhaseCallback& progress) {
  std::unique_ptr<BagWriter> bag;
  if (!request.bag.empty()) {
    bag = std::make_unique<BagWriter>(request.bag, configuration_.model.data_set);
  }
  TrialOutcome outcome;
  const auto take = [&](const ClosedLoopFrame& frame) {
    const Decision& decision = frame.decision;
    outcome.times.push_back(rig_.time());
    outcome.states.push_back(rig_.plant().state());
    outcome.torques.push_back(decision.torque);
    outcome.exploratory.push_back(decision.exploratory);
    if (decision.goal_distance) outcome.goal_distances.push_back(*decision.goal_distance);
    if (decision.solve_time) outcome.solve_times.push_back(*decision.solve_time);
    if (bag != nullptr && frame.index == 0) {
      const ros::Time begin = frame.image.header.stamp;
      const std::string& frame_id = frame.image.header.frame_id;
      bag->writeGoal(imageMessage(rig_.goalImage(), begin, frame_id), begin);
    }
    if (bag != nullptr) write(frame.image, decision, bag.get());
    progress((frame.index + 1.0) / request.num_steps);
  };
  runClosedLoop(&rig_, method_->policy(), request, configuration_, take);
  if (bag != nullptr) bag->close();
  return outcome;
}

}  // namespace ddm
