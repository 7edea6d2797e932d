// A plant in front of a camera: the loop that every driver closes.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/rig.h"

#include <utility>

namespace ddm {

Rig::Rig(std::unique_ptr<Plant> plant, const CameraOptions& camera)
    : plant_(std::move(plant)),
      camera_(camera, plant_->info().dt),
      applied_(Eigen::VectorXd::Zero(plant_->torqueDim())) {}

Picture Rig::reset(std::uint64_t seed, std::uint32_t trial, bool evaluation,
                   const std::optional<Eigen::VectorXd>& start) {
  std::mt19937_64 starts = startStream(seed, trial, evaluation);
  plant_->setState(start ? *start : plant_->drawStart(starts));
  plant_->setGoal(goalOf(*plant_, seed, trial, evaluation));
  camera_.begin(seed, trial, evaluation);
  num_steps_ = 0;
  applied_.setZero();
  return *camera_.photograph(plant_->render(plant_->state()));
}

std::optional<Picture> Rig::step(const Eigen::VectorXd& torque) {
  applied_ = plant_->step(torque);
  ++num_steps_;
  return camera_.photograph(plant_->render(plant_->state()));
}

Picture Rig::stepUntilSeen(const Eigen::VectorXd& torque) {
  for (;;) {
    if (std::optional<Picture> picture = step(torque)) return *std::move(picture);
  }
}

double Rig::time() const { return static_cast<double>(num_steps_) * plant_->info().dt; }

}  // namespace ddm
