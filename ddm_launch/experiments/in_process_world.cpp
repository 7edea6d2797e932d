// The world in this process: plant, recorder, and who learns and acts, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_world.h"

#include <ddm_bag_io/bag_writer.h>
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

}  // namespace

InProcessWorld::InProcessWorld(const Configuration& configuration)
    : configuration_(configuration),
      plant_(makePlant(configuration.plant, configuration.camera)),
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
  options.max_torque = configuration_.mpc.max_torque;
  options.torque_dim = plant_->torqueDim();
  return EpsilonGreedy(request.epsilon < 1.0 ? method_->policy() : nullptr, options, request.id);
}

TrialOutcome InProcessWorld::runTrial(const TrialRequest& request, const PhaseCallback& progress) {
  std::mt19937_64 start = startStream(request.id.seed, request.id.trial, request.id.evaluation);
  plant_->setState(plant_->drawStart(start));
  EpsilonGreedy policy = makePolicy(request);
  std::unique_ptr<BagWriter> bag;
  if (!request.bag.empty()) {
    bag = std::make_unique<BagWriter>(request.bag, configuration_.model.data_set);
    const ros::Time begin = stampOf(0, plant_->dt());
    bag->writeGoal(photograph(*plant_, plant_->goalState(), begin), begin);
  }
  TrialOutcome outcome;
  for (int step = 0; step < request.num_steps; ++step) {
    const sensor_msgs::Image image =
        photograph(*plant_, plant_->state(), stampOf(step, plant_->dt()));
    outcome.times.push_back(step * plant_->dt());
    outcome.states.push_back(plant_->state());
    const Decision decision = policy.decide(decodeImage(image, configuration_.model.image.size));
    outcome.torques.push_back(decision.torque);
    outcome.exploratory.push_back(decision.exploratory);
    if (decision.plan) outcome.solve_times.push_back(decision.plan->solve_time);
    if (bag != nullptr) {
      ddm_msgs::Torque torque;
      torque.header.stamp = image.header.stamp;
      torque.torque.assign(decision.torque.data(), decision.torque.data() + decision.torque.size());
      torque.exploratory = decision.exploratory;
      bag->write(image);
      bag->write(torque);
    }
    plant_->step(decision.torque);
    progress(static_cast<double>(step + 1) / request.num_steps);
  }
  if (bag != nullptr) bag->close();
  return outcome;
}

TrainingOutcome InProcessWorld::train(const std::vector<std::string>& bags, const TrialId& id,
                                      const PhaseCallback& progress) {
  return method_->train(bags, id, progress);
}

}  // namespace ddm
