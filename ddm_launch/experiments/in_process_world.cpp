// The world in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_world.h"

#include <ddm_model/per_motor.h>
#include <ddm_msgs/Torque.h>
#include <ddm_sim/plant_factory.h>

#include <cmath>
#include <stdexcept>

#include "camera_view.h"

namespace ddm {
namespace {

/// Stamp of a frame of a trial that begins at one second, like sim_node's first.
ros::Time stampOf(int step, double dt) {
  const auto step_ns = static_cast<std::uint64_t>(std::llround(dt * 1e9));
  return ros::Time(1, 0) + ros::Duration().fromNSec(static_cast<std::int64_t>(step * step_ns));
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

InProcessWorld::InProcessWorld(const Configuration& configuration)
    : configuration_(configuration),
      plant_(makePlant(configuration.plant, configuration.camera)),
      camera_(configuration.camera),
      method_(configuration.method->make(configuration, *plant_)) {
  if (!configuration.sim.lockstep) {
    throw std::invalid_argument(
        "sim/lockstep must be true where everything runs in one process: use experiment.launch for "
        "real time");
  }
}

EpsilonGreedy InProcessWorld::makePolicy(const TrialRequest& request) const {
  EpsilonGreedy::Options options;
  options.epsilon = request.epsilon;
  options.hold_steps = request.hold_steps;
  options.max_torque =
      perMotor(configuration_.mpc.max_torque, plant_->torqueDim(), "mpc/max_torque");
  return EpsilonGreedy(request.epsilon < 1.0 ? method_->policy() : nullptr, options, request.id);
}

std::unique_ptr<BagWriter> InProcessWorld::openBag(const TrialRequest& request) const {
  if (request.bag.empty()) return nullptr;
  auto bag = std::make_unique<BagWriter>(request.bag, configuration_.model.data_set);
  const ros::Time begin = stampOf(0, plant_->dt());
  bag->writeGoal(imageMessage(camera_.photographGoal(*plant_), plant_->imageSize(), begin), begin);
  return bag;
}

TrialOutcome InProcessWorld::runTrial(const TrialRequest& request, const PhaseCallback& progress) {
  std::mt19937_64 start = startStream(request.id.seed, request.id.trial, request.id.evaluation);
  plant_->setState(plant_->drawStart(start));
  camera_.begin(request.id.seed, request.id.trial, request.id.evaluation);
  EpsilonGreedy policy = makePolicy(request);
  const std::unique_ptr<BagWriter> bag = openBag(request);
  TrialOutcome outcome;
  Eigen::VectorXd torque;  // goes on where a frame is lost; the first one never is
  for (int step = 0, frame = 0; frame < request.num_steps; ++step) {
    if (step > 0) plant_->step(torque);
    if (const auto photograph = camera_.photograph(*plant_)) {
      const sensor_msgs::Image image =
          imageMessage(*photograph, plant_->imageSize(), stampOf(step, plant_->dt()));
      outcome.times.push_back(step * plant_->dt());
      outcome.states.push_back(plant_->state());
      const Decision decision = policy.decide(decodeImage(image, configuration_.model.image.size));
      torque = decision.torque;
      outcome.torques.push_back(torque);
      outcome.exploratory.push_back(decision.exploratory);
      if (decision.goal_distance) outcome.goal_distances.push_back(*decision.goal_distance);
      if (decision.solve_time) outcome.solve_times.push_back(*decision.solve_time);
      if (bag != nullptr) write(image, decision, bag.get());
      progress(static_cast<double>(++frame) / request.num_steps);
    }
  }
  if (bag != nullptr) bag->close();
  return outcome;
}

TrainingOutcome InProcessWorld::train(const std::vector<std::string>& bags, const TrialId& id,
                                      const PhaseCallback& progress) {
  return method_->train(bags, id, progress);
}

}  // namespace ddm
