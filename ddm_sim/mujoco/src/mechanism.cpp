// Implements Mechanism: the ranges of joints, the loads on them, and random motions.
// SPDX-License-Identifier: BSD-3-Clause
#include "mechanism.h"

#include <algorithm>
#include <cmath>

#include "ddm_sim/plant.h"
#include "mujoco_physics.h"

namespace ddm {

using Eigen::VectorXd;

VectorXd atRest(const VectorXd& position) {
  VectorXd state = VectorXd::Zero(2 * position.size());
  state.head(position.size()) = position;
  return state;
}

Mechanism::Mechanism(const std::shared_ptr<const MujocoModel>& model)
    : model_(model), data_(makeData(model->get())) {
  requirePositionsAndRates(*model);
  const mjModel& m = model->get();
  const Eigen::Matrix3Xd corners = movingCorners(m, place(qpos0()));
  if (corners.cols() > 0) {
    size_ = (corners.rowwise().maxCoeff() - corners.rowwise().minCoeff()).maxCoeff();
  }
  for (int i = 0; i < m.njnt; ++i) {
    ModelJoint joint;
    joint.name = model->name(mjOBJ_JOINT, i);
    joint.kind = m.jnt_type[i] == mjJNT_HINGE ? JointKind::kAngle : JointKind::kLength;
    joint.limited = m.jnt_limited[i] != 0;
    joint.effort = model->effortLimit(joint.name).value_or(0.0);
    const double reach = joint.isHinge() ? kPi : size_;
    joint.lower = joint.limited ? m.jnt_range[2 * i] : m.qpos0[i] - reach;
    joint.upper = joint.limited ? m.jnt_range[2 * i + 1] : m.qpos0[i] + reach;
    joints_.push_back(joint);
  }
}

VectorXd Mechanism::qpos0() const {
  return Eigen::Map<const VectorXd>(model_->get().qpos0, model_->get().njnt);
}

VectorXd Mechanism::draw(std::mt19937_64* engine) const {
  VectorXd position(static_cast<Eigen::Index>(joints_.size()));
  for (Eigen::Index i = 0; i < position.size(); ++i) {
    const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
    position[i] = std::uniform_real_distribution<double>(joint.lower, joint.upper)(*engine);
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
    position[i] = std::clamp(position[i], joint.lower, joint.upper);
  }
  return position;
}

VectorXd Mechanism::atLimits(VectorXd position) const {
  for (Eigen::Index i = 0; i < position.size(); ++i) {
    const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
    if (!joint.limited) continue;
    const bool low = position[i] - joint.lower < joint.upper - position[i];
    position[i] = low ? joint.lower : joint.upper;
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
  if (!springs) m.opt.disableflags |= mjDSBL_PASSIVE;
  place(position);
  mj_energyPos(&m, data_.get());
  return data_->energy[0];
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

double Mechanism::speedUnderRandomTorques(const MujocoOptions& options, std::size_t num_motors,
                                          double share) const {
  constexpr int kRuns = 8;
  constexpr double kSeconds = 2.0;  // duration of a run [s]
  constexpr double kHold = 0.3;     // time for which a random torque is constant [s]
  const MujocoPhysics physics(model_, options);
  const int n = physics.numJoints();
  const double timestep = timestepOf(*model_, options);
  const int hold = std::max(1, static_cast<int>(std::round(kHold / timestep)));
  std::vector<double> speeds;
  std::mt19937_64 engine(2);
  for (int run = 0; run < kRuns; ++run) {
    const std::vector<double>& pose = run % 2 == 0 ? options.start : options.goal;
    VectorXd state = atRest(Eigen::Map<const VectorXd>(pose.data(), n));
    for (double time = 0.0; time < kSeconds; time += hold * timestep) {
      VectorXd torque(static_cast<Eigen::Index>(num_motors));
      for (Eigen::Index i = 0; i < torque.size(); ++i) {
        const double limit = share * options.max_torque[static_cast<std::size_t>(i)];
        torque[i] = std::uniform_real_distribution<double>(-limit, limit)(engine);
      }
      const Eigen::MatrixXd states = physics.frames(state, torque, hold);
      for (Eigen::Index k = 0; k < states.cols(); ++k) {
        double fastest = 0.0;
        for (int i = 0; i < n; ++i) {
          fastest = std::max(fastest, std::abs(states(n + i, k)) / unit(i));
        }
        speeds.push_back(fastest);
      }
      state = states.rightCols(1);
    }
  }
  std::sort(speeds.begin(), speeds.end());
  return speeds[speeds.size() * 95 / 100];
}

}  // namespace ddm
