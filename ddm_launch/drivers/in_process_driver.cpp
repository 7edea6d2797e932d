// Everything in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_driver.h"

#include <ddm_bag_io/bag_writer.h>
#include <ddm_msgs/Torque.h>
#include <ddm_sim/plant_factory.h>

#include <stdexcept>

#include "closed_loop.h"
#include "method_kinds.h"

namespace ddm {
namespace {

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

InProcessDriver::InProcessDriver(const Configuration& configuration)
    : configuration_(configuration),
      environment_(makePlant(*configuration.plant), configuration.camera),
      method_(
          methodKind(configuration.experiment.method).make(configuration, environment_.plant())) {
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
    outcome.times.push_back(environment_.time());
    outcome.states.push_back(environment_.plant().state());
    outcome.torques.push_back(decision.torque);
    outcome.exploratory.push_back(decision.exploratory);
    if (decision.goal_distance) outcome.goal_distances.push_back(*decision.goal_distance);
    if (decision.solve_time) outcome.solve_times.push_back(*decision.solve_time);
    if (bag != nullptr && frame.index == 0) {
      const ros::Time begin = frame.image.header.stamp;
      const std::string& frame_id = frame.image.header.frame_id;
      bag->writeGoal(imageMessage(environment_.goalImage(), begin, frame_id), begin);
    }
    if (bag != nullptr) write(frame.image, decision, bag.get());
    progress((frame.index + 1.0) / request.num_steps);
  };
  runClosedLoop(&environment_, method_->policy(), request, configuration_, take);
  if (bag != nullptr) bag->close();
  return outcome;
}

}  // namespace ddm
