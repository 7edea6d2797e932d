// Implements a model at rest: the ranges of its joints and the loads on them.
// SPDX-License-Identifier: BSD-3-Clause
#include "mechanism.h"

#include <algorithm>
#include <cmath>

#include "ddm_sim/angles.h"
#include "mujoco_physics.h"

namespace ddm {

using Eigen::VectorXd;

Mechanism::Mechanism(const std::shared_ptr<const MujocoModel>& model)
    : model_(model), data_(makeData(model->get())) {
  requirePositionsAndRates(*model);
  const mjModel& m = model->get();
  for (int i = 0; i < m.njnt; ++i) {
    ModelJoint joint;
    joint.name = model->name(mjOBJ_JOINT, i);
    joint.kind = m.jnt_type[i] == mjJNT_HINGE ? JointKind::kAngle : JointKind::kLength;
    joint.limited = m.jnt_limited[i] != 0;
    joint.effort = model->effortLimit(joint.name).value_or(0.0);
    // showSlidesInPart() sets the range of a slide.
    const double reach = joint.isHinge() ? kPi : 0.0;
    joint.lower = joint.limited ? m.jnt_range[2 * i] : m.qpos0[i] - reach;
    joint.upper = joint.limited ? m.jnt_range[2 * i + 1] : m.qpos0[i] + reach;
    joint.shown_lower = joint.lower;
    joint.shown_upper = joint.upper;
    joints_.push_back(joint);
  }
  showSlidesInPart();
}

VectorXd Mechanism::zero() const {
  return coupled(Eigen::Map<const VectorXd>(model_->get().qpos0, model_->get().njnt));
}

VectorXd Mechanism::draw(std::mt19937_64* engine) const {
  VectorXd position(static_cast<Eigen::Index>(joints_.size()));
  for (Eigen::Index i = 0; i < position.size(); ++i) {
    const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
    position[i] =
        std::uniform_real_distribution<double>(joint.shown_lower, joint.shown_upper)(*engine);
  }
  return coupled(position);
}

bool Mechanism::follows(int joint) const {
  const mjModel& m = model_->get();
  for (int i = 0; i < m.neq; ++i) {
    if (m.eq_type[i] == mjEQ_JOINT && m.eq_active[i] && m.eq_obj1id[i] == joint) return true;
  }
  return false;
}

VectorXd Mechanism::withFollowers(VectorXd position) const {
  const mjModel& m = model_->get();
  // Once for each coupling, because a leader may follow a joint whose coupling comes later.
  for (int k = 0; k < m.neq * m.neq; ++k) {
    const int i = k % m.neq;
    if (m.eq_type[i] != mjEQ_JOINT || !m.eq_active[i]) continue;
    const int follower = m.eq_obj1id[i], leader = m.eq_obj2id[i];
    const mjtNum* const c = m.eq_data + mjNEQDATA * i;
    const double x = leader < 0 ? 0.0 : position[leader] - m.qpos0[leader];
    position[follower] = m.qpos0[follower] + c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
  }
  return position;
}

VectorXd Mechanism::coupled(VectorXd position) const {
  position = withFollowers(position);
  for (Eigen::Index i = 0; i < position.size(); ++i) {
    const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
    if (joint.turnsFreely()) continue;
    position[i] = std::clamp(position[i], joint.shown_lower, joint.shown_upper);
  }
  return position;
}

VectorXd Mechanism::atLimits(VectorXd position) const {
  for (Eigen::Index i = 0; i < position.size(); ++i) {
    const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
    if (!joint.limited) continue;
    const bool low = position[i] - joint.shown_lower < joint.shown_upper - position[i];
    position[i] = low ? joint.shown_lower : joint.shown_upper;
  }
  return coupled(position);
}

bool Mechanism::overlaps(const VectorXd& position) const {
  constexpr double kTouching = 1e-3;  // contacts at rest are this deep [m]
  const mjData& placed = place(position);
  return std::any_of(placed.contact, placed.contact + placed.ncon,
                     [](const mjContact& contact) { return contact.dist < -kTouching; });
}

const mjData& Mechanism::place(const VectorXd& position) const {
  std::copy_n(position.data(), position.size(), data_->qpos);
  std::fill_n(data_->qvel, position.size(), 0.0);
  mj_fwdPosition(&model_->get(), data_.get());
  return *data_;
}

VectorXd Mechanism::load(const VectorXd& position, bool springs) const {
  place(position);
  mj_fwdVelocity(&model_->get(), data_.get());
  VectorXd load = Eigen::Map<const VectorXd>(data_->qfrc_bias, position.size());
  if (springs) load -= Eigen::Map<const VectorXd>(data_->qfrc_passive, position.size());
  return load;
}

double Mechanism::energy(const VectorXd& position, bool springs) const {
  mjModel m = model_->get();
  m.opt.enableflags |= mjENBL_ENERGY;
  place(position);
  mj_energyPos(&m, data_.get());
  double energy = springs ? data_->energy[0] : 0.0;
  for (int i = 1; i < m.nbody && !springs; ++i) {
    energy -= m.body_mass[i] * mju_dot3(m.opt.gravity, data_->xipos + 3 * i);
  }
  return energy;
}

VectorXd Mechanism::motion(int joint, const VectorXd& position) const {
  constexpr double kStep = 1e-6;
  const VectorXd moved = position + kStep * VectorXd::Unit(position.size(), joint);
  return (withFollowers(moved) - withFollowers(position)) / kStep;
}

double Mechanism::inertia(const VectorXd& rates, const VectorXd& position) const {
  place(position);
  VectorXd momentum(rates.size());
  mj_mulM(&model_->get(), data_.get(), momentum.data(), rates.data());
  return rates.dot(momentum);
}

VectorXd Mechanism::highest(const std::vector<VectorXd>& poses) const {
  const auto less = [this](const VectorXd& a, const VectorXd& b) {
    return energy(a, false) < energy(b, false);
  };
  return followed(*std::max_element(poses.begin(), poses.end(), less), 1.0);
}

/// Follows the gradient to a minimum (sign -1) or maximum (sign 1) of the potential energy. The
/// maximum excludes the energy of springs, which has no upper bound.
VectorXd Mechanism::followed(VectorXd position, double sign) const {
  const bool springs = sign < 0.0;
  double step = 0.1, best = sign * energy(position, springs);
  for (int i = 0; i < 1000 && step > 1e-6; ++i) {
    VectorXd change = sign * load(position, springs);
    for (Eigen::Index k = 0; k < change.size(); ++k) {
      change[k] /= std::max(1e-12, inertia(VectorXd::Unit(change.size(), k), position));
    }
    const double largest = change.lpNorm<Eigen::Infinity>();
    if (largest < 1e-9) break;
    const VectorXd next = coupled(position + std::min(1.0, step / largest) * change);
    const double energy_there = sign * energy(next, springs);
    if (energy_there > best) {
      best = energy_there;
      position = next;
    } else {
      step *= 0.5;
    }
  }
  return position;
}

/// Limits the range of slides that the camera shows. The size of the robot is the largest side of
/// the space that the robot needs with its slides at rest. A slide that is much longer than this
/// size, or endless, would make the robot tiny in the image.
void Mechanism::showSlidesInPart() {
  // Number of poses from which the size of the robot is computed.
  constexpr int kPoses = 200;
  constexpr double kWideSlide = 4.0;  // a longer slide is shown in part [sizes of the robot]
  std::mt19937_64 engine(0);
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (int i = 0; i < kPoses; ++i) {
    VectorXd position = draw(&engine);
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      if (!joints_[k].isHinge()) position[static_cast<Eigen::Index>(k)] = model_->get().qpos0[k];
    }
    const Eigen::Matrix3Xd corners = movingCorners(model_->get(), place(position));
    if (corners.cols() == 0) continue;
    low = low.cwiseMin(corners.rowwise().minCoeff());
    high = high.cwiseMax(corners.rowwise().maxCoeff());
  }
  size_ = std::max(1e-3, (high - low).maxCoeff());
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    ModelJoint& joint = joints_[k];
    const double wide = joint.upper - joint.lower;
    if (joint.isHinge() || (joint.limited && wide <= kWideSlide * size_)) continue;
    const double zero = std::clamp<double>(model_->get().qpos0[k], joint.lower, joint.upper);
    if (!joint.limited) {
      joint.lower = zero - size_;
      joint.upper = zero + size_;
    }
    joint.shown_lower = std::max(joint.lower, zero - size_);
    joint.shown_upper = std::min(joint.upper, zero + size_);
  }
}

}  // namespace ddm
