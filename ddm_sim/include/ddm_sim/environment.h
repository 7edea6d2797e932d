// The environment: a plant in front of a camera, with reset and step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "ddm_sim/camera.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// Moves a plant and takes one camera image in each time step.
class Environment {
 public:
  /// @throws std::invalid_argument with all problems of the options
  Environment(std::unique_ptr<Plant> plant, const CameraOptions& camera)
      : plant_(std::move(plant)),
        camera_(camera, plant_->info().dt),
        applied_(Eigen::VectorXd::Zero(plant_->torqueDim())) {}

  /// Sets the initial state and the goal of an episode, and returns its first image, which is never
  /// lost.
  /// @param start  (optional) initial state, taken exactly; without it the initial state is drawn
  /// @throws std::invalid_argument if `start` is not a state or the goal is out of reach; the
  ///         environment is then unchanged
  RenderedImage reset(const TrialId& id, const std::optional<Eigen::VectorXd>& start = {}) {
    const Eigen::VectorXd goal = goalOf(*plant_, id);
    std::mt19937_64 starts = randomStream(id, StreamRole::kStart);
    plant_->setState(start ? *start : plant_->drawStart(starts));
    plant_->setGoal(goal);
    camera_.begin(id);
    num_steps_ = 0;
    applied_.setZero();
    return *camera_.capture(plant_->render(plant_->state()));
  }

  /// Moves the plant by one time step under a constant torque.
  /// @return the image that the camera delivers now, or nothing if that image is lost
  /// @throws as Plant::step(); the environment is then unchanged
  std::optional<RenderedImage> step(const Eigen::VectorXd& torque) {
    try {
      applied_ = plant_->step(torque);
    } catch (const std::range_error& e) {
      throw std::range_error(std::string(e.what()) + " (in step " + std::to_string(num_steps_) +
                             " since the reset)");
    }
    ++num_steps_;
    return camera_.capture(plant_->render(plant_->state()));
  }

  /// Repeats step() with the same torque until the camera delivers an image.
  /// @throws as Plant::step(); the steps before the failing one stay done
  RenderedImage stepUntilSeen(const Eigen::VectorXd& torque) {
    for (;;) {
      if (std::optional<RenderedImage> rendered = step(torque)) return *std::move(rendered);
    }
  }

  /// The goal image of this episode, as the camera takes it.
  RenderedImage goalImage() { return camera_.captureGoal(plant_->render(plant_->goal())); }

  const Plant& plant() const { return *plant_; }
  std::uint64_t numSteps() const { return num_steps_; }  ///< time steps since the reset
  /// Time since the reset [s].
  double time() const { return static_cast<double>(num_steps_) * plant_->info().dt; }
  /// Torque of the last step, zero after a reset.
  const Eigen::VectorXd& applied() const { return applied_; }

 private:
  std::unique_ptr<Plant> plant_;
  Camera camera_;
  std::uint64_t num_steps_ = 0;
  Eigen::VectorXd applied_;
};

}  // namespace ddm
