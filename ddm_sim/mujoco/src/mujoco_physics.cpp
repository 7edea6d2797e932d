// Implements MujocoPhysics: simulates a model from one state to the next.
// SPDX-License-Identifier: BSD-3-Clause
#include "mujoco_physics.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "ddm_sim/plant.h"
#include "model_files.h"

namespace ddm {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A copy of the model. If the options name motors, all actuators of the file are disabled.
mjModel physicsOf(const MujocoModel& model, const MujocoOptions& options) {
  mjModel physics = model.get();
  physics.opt.timestep = timestepOf(model, options);
  if (!options.motors.empty()) physics.opt.disableflags |= mjDSBL_ACTUATION;
  return physics;
}

}  // namespace

void requirePositionsAndRates(const MujocoModel& model) {
  const mjModel& m = model.get();
  for (int i = 0; i < m.njnt; ++i) {
    if (m.jnt_type[i] == mjJNT_HINGE || m.jnt_type[i] == mjJNT_SLIDE) continue;
    refuseModel("plant/model must have hinges and slides alone, got the ",
                m.jnt_type[i] == mjJNT_FREE ? "free" : "ball", " joint ",
                model.name(mjOBJ_JOINT, i), " of ", model.uri(),
                ": fix that body, or move it by hinges and slides");
  }
  if (m.njnt == 0)
    refuseModel("plant/model must have a joint that moves, got none in ", model.uri());
  for (int i = 0; i < m.nv; ++i) {
    const bool damped = m.dof_damping[i] >= 0.0;
    if (damped && m.dof_frictionloss[i] >= 0.0) continue;
    refuseModel("the joint ", model.name(mjOBJ_JOINT, m.dof_jntid[i]), " of ", model.uri(),
                " must have a ", damped ? "friction" : "damping", " >= 0, got ",
                damped ? m.dof_frictionloss[i] : m.dof_damping[i],
                ", which drives the joint: correct its sign");
  }
}

double timestepOf(const MujocoModel& model, const MujocoOptions& options) {
  constexpr double kSmallest = 2e-5;  // below this step the simulation is slower than real time [s]
  if (options.timestep > 0.0) return options.timestep;
  const double timestep = model.get().opt.timestep;
  if (timestep >= kSmallest) return timestep;
  refuseModel(
      "the timestep of ", model.uri(), " must be at least ", kSmallest, " s, got ", timestep,
      ": write <option timestep=\"0.002\"/> in the file, or set plant/timestep in the plant file");
}

MujocoPhysics::MujocoPhysics(std::shared_ptr<const MujocoModel> model, const MujocoOptions& options)
    : model_(std::move(model)),
      physics_(physicsOf(*model_, options)),
      motors_(motorsOf(*model_, options)),
      data_(makeData(physics_)) {}

/// Sets all variables that the next physics step depends on. This takes a hundredth of the time of
/// mj_resetData().
void MujocoPhysics::set(const Eigen::VectorXd& state) const {
  const int n = numJoints();
  mjData* const data = data_.get();
  std::copy_n(state.data(), n, data->qpos);
  std::copy_n(state.data() + n, n, data->qvel);
  std::fill_n(data->qacc_warmstart, n, 0.0);
  std::fill_n(data->qfrc_applied, n, 0.0);
  std::fill_n(data->ctrl, physics_.nu, 0.0);
  std::fill_n(data->act, physics_.na, 0.0);
  for (int i = 0; i < physics_.nbody; ++i) {
    if (physics_.body_mocapid[i] < 0) continue;
    std::copy_n(physics_.body_pos + 3 * i, 3, data->mocap_pos + 3 * physics_.body_mocapid[i]);
  }
  data->time = 0.0;
  data->pstack = 0;  // an earlier error may have left the stack in use
  for (mjWarningStat& warning : data->warning) warning.number = 0;
}

void MujocoPhysics::requireStable(int frame, const Eigen::VectorXd& state) const {
  for (int i = 0; i < mjNWARNING; ++i) {
    const mjWarningStat& warning = data_->warning[i];
    if (warning.number == 0) continue;
    throw std::range_error(
        textOf("plant: the simulation of ", model_->uri(), " is unstable, MuJoCo says \"",
               mju_warningText(i, warning.lastinfo), "\" in frame ", frame + 1,
               " of the step from the state ", fewNumbers(state),
               ": use a smaller plant/timestep than ", physics_.opt.timestep,
               " s, more damping or armature in the file, or a smaller plant/max_torque"));
  }
}

Eigen::MatrixXd MujocoPhysics::frames(const Eigen::VectorXd& state, const Eigen::VectorXd& torque,
                                      int num_frames) const {
  const int n = numJoints();
  Eigen::MatrixXd states(2 * n, num_frames);
  set(state);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    data_->qfrc_applied[motors_[i].joint] = torque[static_cast<Eigen::Index>(i)];
  }
  for (int frame = 0; frame < num_frames; ++frame) {
    mj_step(&physics_, data_.get());
    requireStable(frame, state);  // MuJoCo resets an unstable simulation to its first pose
    std::copy_n(data_->qpos, n, states.col(frame).data());
    std::copy_n(data_->qvel, n, states.col(frame).data() + n);
  }
  return states;
}

const mjData& MujocoPhysics::placed(const Eigen::VectorXd& state,
                                    const std::optional<Eigen::Vector2d>& target) const {
  set(state);
  const int body = target ? mj_name2id(&physics_, mjOBJ_BODY, "target") : -1;
  const int mocap = body < 0 ? -1 : physics_.body_mocapid[body];
  if (mocap >= 0) std::copy_n(target->data(), 2, data_->mocap_pos + 3 * mocap);
  mj_kinematics(&physics_, data_.get());
  mj_comPos(&physics_, data_.get());
  mj_camlight(&physics_, data_.get());
  mj_tendon(&physics_, data_.get());
  return *data_;
}

const mjtNum* MujocoPhysics::at(const Place& place) const {
  return (place.type == mjOBJ_SITE ? data_->site_xpos : data_->xipos) + 3 * place.id;
}

Eigen::VectorXd MujocoPhysics::places(const std::vector<Place>& places,
                                      const Eigen::VectorXd& state) const {
  placed(state);
  Eigen::VectorXd out(3 * static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) std::copy_n(at(places[i]), 3, out.data() + 3 * i);
  return out;
}

Eigen::VectorXd MujocoPhysics::bodies(const Eigen::VectorXd& state) const {
  const mjModel& m = physics_;
  const mjData& data = placed(state);
  std::vector<double> out;
  for (int i = 1; i < m.nbody; ++i) {
    if (m.body_dofnum[m.body_weldid[i]] == 0) continue;  // the body does not move
    out.insert(out.end(), data.xipos + 3 * i, data.xipos + 3 * i + 3);
  }
  return Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

bool MujocoPhysics::withinRanges(const Eigen::VectorXd& state) const {
  const mjModel& m = physics_;
  for (int i = 0; i < m.njnt; ++i) {
    if (!m.jnt_limited[i]) continue;
    if (state[i] < m.jnt_range[2 * i] || state[i] > m.jnt_range[2 * i + 1]) return false;
  }
  return true;
}

/// Moves a place to a point of the x-y plane by Gauss-Newton steps of at most 1 rad or m. With J
/// the Jacobian of the place and d the distance to the point:
///
///   q <- q + J^T (J J^T + kDamping I)^-1 d
///
/// @param state  in: initial state; out: solution
/// @return false if the iterations do not converge, or if a joint leaves its range
bool MujocoPhysics::approach(const Place& place, const Eigen::Vector2d& point,
                             Eigen::VectorXd* state) const {
  constexpr int kIterations = 100;
  constexpr double kReached = 1e-14;
  constexpr double kDamping = 1e-12;  // far below the square of a link's length [m^2]
  const mjModel& m = physics_;
  const int n = m.nv;
  RowMajor jacobian(3, n);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    placed(*state);
    const Eigen::Vector2d missing = point - Eigen::Map<const Eigen::Vector2d>(at(place));
    if (missing.norm() <= kReached) return withinRanges(*state);
    const auto jacobian_of = place.type == mjOBJ_SITE ? mj_jacSite : mj_jacBodyCom;
    jacobian_of(&m, data_.get(), jacobian.data(), nullptr, place.id);
    const Eigen::MatrixXd J = jacobian.topRows(2);
    const Eigen::Matrix2d JJ = J * J.transpose() + kDamping * Eigen::Matrix2d::Identity();
    Eigen::VectorXd change = J.transpose() * JJ.inverse() * missing;
    change /= std::max(1.0, change.lpNorm<Eigen::Infinity>());
    state->head(n) += change;
    for (int i = 0; i < n; ++i) {
      if (m.jnt_type[i] == mjJNT_HINGE) (*state)[i] = std::remainder((*state)[i], 2.0 * kPi);
    }
  }
  return false;
}

Eigen::VectorXd MujocoPhysics::reach(const Place& place, const Eigen::Vector2d& point,
                                     const Eigen::VectorXd& guess) const {
  constexpr int kTries = 100;
  const mjModel& m = physics_;
  std::mt19937_64 engine(0);  // fixed seed: the pose depends only on the point
  for (int i = 0; i < kTries; ++i) {
    Eigen::VectorXd state = guess;
    state.tail(m.nv).setZero();
    for (int joint = 0; i > 0 && joint < m.njnt; ++joint) {
      const mjtNum* const range = m.jnt_range + 2 * joint;
      const bool limited = m.jnt_limited[joint];
      std::uniform_real_distribution<double> uniform(limited ? range[0] : -kPi,
                                                     limited ? range[1] : kPi);
      state[joint] = uniform(engine);
    }
    if (approach(place, point, &state)) return state;
  }
  refuseModel("the target must be within reach of ", model_->name(place.type, place.id), " of ",
              model_->uri(), ", got ", fewNumbers(point));
}

}  // namespace ddm
