// A plant in front of a camera: the loop that every driver closes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "ddm_sim/camera.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// Plant and camera move together: one photograph in each time step.
class Environment {
 public:
  /// @throws std::invalid_argument with all problems of the options
  Environment(std::unique_ptr<Plant> plant, const CameraOptions& camera)
      : plant_(std::move(plant)),
        camera_(camera, plant_->info().dt),
        applied_(Eigen::VectorXd::Zero(plant_->torqueDim())) {}

  /// Start and goal of a run, and its first photograph, which is never lost.
  /// @param seed        seed of the experiment
  /// @param trial       number of the trial, 0 is the random one
  /// @param evaluation  the greedy run after `trial`
  /// @param start       (optional) this state, digit by digit, instead of a drawn one
  /// @throws std::invalid_argument if the start is not a state or the goal out of reach; nothing
  ///         has changed
  Picture reset(std::uint64_t seed, std::uint32_t trial, bool evaluation,
                const std::optional<Eigen::VectorXd>& start = {}) {
    const Eigen::VectorXd goal = goalOf(*plant_, seed, trial, evaluation);
    std::mt19937_64 starts = startStream(seed, trial, evaluation);
    plant_->setState(start ? *start : plant_->drawStart(starts));
    plant_->setGoal(goal);
    camera_.begin(seed, trial, evaluation);
    num_steps_ = 0;
    applied_.setZero();
    return *camera_.photograph(plant_->render(plant_->state()));
  }

  /// One time step under a constant torque.
  /// @return what the camera shows now, or nothing if that frame is lost
  /// @throws as Plant::step(); nothing has changed
  std::optional<Picture> step(const Eigen::VectorXd& torque) {
    try {
      applied_ = plant_->step(torque);
    } catch (const std::range_error& e) {
      throw std::range_error(std::string(e.what()) + " (in step " + std::to_string(num_steps_) +
                             " since the reset)");
    }
    ++num_steps_;
    return camera_.photograph(plant_->render(plant_->state()));
  }

  /// Time steps under a constant torque until a frame is seen.
  /// @throws as Plant::step(), at the state that was reached
  Picture stepUntilSeen(const Eigen::VectorXd& torque) {
    for (;;) {
      if (std::optional<Picture> picture = step(torque)) return *std::move(picture);
    }
  }

  /// The goal of this run as the camera sees it.
  Picture goalImage() { return camera_.photographGoal(plant_->render(plant_->goal())); }

  const Plant& plant() const { return *plant_; }
  std::uint64_t numSteps() const { return num_steps_; }  ///< since the reset
  /// Since the reset [s].
  double time() const { return static_cast<double>(num_steps_) * plant_->info().dt; }
  const Eigen::VectorXd& applied() const { return applied_; }  ///< torque of the last step, or zero

 private:
  std::unique_ptr<Plant> plant_;
  Camera camera_;
  std::uint64_t num_steps_ = 0;
  Eigen::VectorXd applied_;
};

}  // namespace ddm
