// Driver that runs plant, recorder and learner in one process, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_driver.h"

#include <ddm_bag_io/bag_writer.h>
#include <ddm_common/image_codec.h>
#include <ddm_model/per_motor.h>
#include <ddm_msgs/Torque.h>
#include <ddm_sim/plant.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "method.h"

namespace ddm {
namespace {

/// Stamp of the current image. The clock of an episode begins at 1 s, as in sim_node.
ros::Time stampOf(const Environment& environment) {
  const auto step_ns =
      static_cast<std::uint64_t>(std::llround(environment.plant().info().dt * 1e9));
  return ros::Time(1, 0) +
         ros::Duration().fromNSec(static_cast<std::int64_t>(environment.numSteps() * step_ns));
}

/// Writes an image and the torque that the policy chose on it.
void write(const sensor_msgs::Image& image, const Decision& decision, BagWriter* bag) {
  ddm_msgs::Torque torque;
  torque.header.stamp = image.header.stamp;
  torque.torque.assign(decision.torque.data(), decision.torque.data() + decision.torque.size());
  torque.exploratory = decision.exploratory;
  bag->write(image);
  bag->write(torque);
}

}  // namespace

void runClosedLoop(Environment* environment, std::shared_ptr<Policy> policy,
                   const TrialRequest& request, const Configuration& configuration,
                   const std::function<void(const sensor_msgs::Image&, const Decision&)>& take) {
  const TrialId& id = request.id;
  const int image_size = configuration.model.image.size;
  EpsilonGreedy::Options options;
  options.epsilon = request.epsilon;
  options.hold_steps = request.hold_steps;
  options.max_torque =
      perMotor(configuration.mpc.max_torque, environment->plant().torqueDim(), "mpc/max_torque");
  EpsilonGreedy explorer(request.epsilon < 1.0 ? std::move(policy) : nullptr, options, id);
  RenderedImage rendered = environment->reset(id);
  explorer.setGoal(
      decodeImage(imageMessage(environment->goalImage(), stampOf(*environment)), image_size));
  const std::string optical_frame = opticalFrame(environment->plant().cameraModel());
  Decision decision;
  for (int step = 0; step < request.num_steps; ++step) {
    if (step > 0) {
      const std::uint64_t steps = environment->numSteps();
      rendered = environment->stepUntilSeen(decision.torque);
      // After a lost image, a new segment begins.
      if (environment->numSteps() > steps + 1) explorer.startSegment();
    }
    const sensor_msgs::Image image = imageMessage(rendered, stampOf(*environment), optical_frame);
    decision = explorer.decide(decodeImage(image, image_size));
    take(image, decision);
  }
}

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
  if (configuration.robot) {
    throw std::invalid_argument(
        "the block robot must be left out where a plant is simulated: use robot.launch instead");
  }
}

TrialOutcome InProcessDriver::runTrial(const TrialRequest& request, const PhaseCallback& progress) {
  std::unique_ptr<BagWriter> bag;
  if (!request.bag.empty()) {
    bag = std::make_unique<BagWriter>(request.bag, configuration_.model.data_set);
  }
  TrialOutcome outcome;
  const auto take = [&](const sensor_msgs::Image& image, const Decision& decision) {
    outcome.times.push_back(environment_.time());
    outcome.states.push_back(environment_.plant().state());
    outcome.torques.push_back(decision.torque);
    outcome.exploratory.push_back(decision.exploratory);
    if (decision.goal_distance) outcome.goal_distances.push_back(*decision.goal_distance);
    if (decision.solve_time) outcome.solve_times.push_back(*decision.solve_time);
    if (bag != nullptr && outcome.torques.size() == 1) {
      const ros::Time begin = image.header.stamp;
      bag->writeGoal(imageMessage(environment_.goalImage(), begin, image.header.frame_id), begin);
    }
    if (bag != nullptr) write(image, decision, bag.get());
    progress(static_cast<double>(outcome.torques.size()) / request.num_steps);
  };
  runClosedLoop(&environment_, method_->policy(), request, configuration_, take);
  if (bag != nullptr) bag->close();
  return outcome;
}

}  // namespace ddm
