// A plant for a model file that has none yet: what the file says, and a proposal for the rest.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/plant_proposal.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <random>
#include <sstream>
#include <stdexcept>

#include "camera_placement.h"
#include "ddm_mujoco/mujoco_plant.h"
#include "ddm_sim/angles.h"
#include "motors.h"
#include "mujoco_physics.h"
#include "xml_text.h"

namespace ddm {
namespace {

using boost::algorithm::join;
using Eigen::VectorXd;

constexpr int kMaxMotors = 2;       // without being asked for more
constexpr int kNumPoses = 200;      // that the camera has to see
constexpr double kWideSlide = 4.0;  // a longer slide is shown in part [sizes of the robot]
constexpr double kAcceleration =
    10;  // that a proposed torque gives [rad/s^2], slides [sizes/s^2 / 2]
constexpr double kTooStrong = 4.0;  // a file's limit beyond so many proposed torques is not used
constexpr double kStep = 0.8;       // motion between two images that dt aims at [rad]
constexpr double kFastest = 40.0;   // so that dt is not below the 0.02 s of a usual camera [rad/s]
constexpr double kSeconds = 2.0;    // of a simulation
constexpr double kHold = 0.3;       // a random torque is held [s]
constexpr double kStartStd = 0.1;   // [rad]

bool isHinge(const ModelJoint& joint) { return joint.kind == JointKind::kAngle; }

std::string shortText(double number, const char* format = "%.3g") {
  char out[32];
  std::snprintf(out, sizeof(out), format, number);
  return out;
}

/// To two digits.
double rounded(double number) { return std::stod(shortText(number, "%.2g")); }

/// Angles near a multiple of a quarter turn are that multiple; others have three digits after the point.
double roundedPosition(double position, bool angle) {
  const double quarters = std::round(position / (0.5 * kPi));
  if (angle && std::abs(position - 0.5 * kPi * quarters) < 3e-3) return 0.5 * kPi * quarters;
  return std::round(position * 1e3) / 1e3 + 0.0;  // + 0.0: never -0
}

/// A model at rest: where its joints may be, and what pulls at them.
class Mechanism {
 public:
  Mechanism(const std::shared_ptr<const MujocoModel>& model)
      : model_(model), data_(nullptr, mj_deleteData) {
    requirePositionsAndRates(*model);
    data_.reset(mj_makeData(&model->get()));
    if (!data_) throw std::runtime_error("not enough memory for " + model->uri());
    const mjModel& m = model->get();
    for (int i = 0; i < m.njnt; ++i) {
      ModelJoint joint;
      joint.name = model->name(mjOBJ_JOINT, i);
      joint.kind = m.jnt_type[i] == mjJNT_HINGE ? JointKind::kAngle : JointKind::kLength;
      joint.limited = m.jnt_limited[i] != 0;
      joint.lower = joint.limited ? m.jnt_range[2 * i] : m.qpos0[i] - (isHinge(joint) ? kPi : 0.0);
      joint.upper =
          joint.limited ? m.jnt_range[2 * i + 1] : m.qpos0[i] + (isHinge(joint) ? kPi : 0.0);
      joint.shown_lower = joint.lower;
      joint.shown_upper = joint.upper;
      joints_.push_back(joint);
    }
    showSlidesInPart();
  }

  const std::vector<ModelJoint>& joints() const { return joints_; }
  double size() const { return size_; }

  /// The length that motions of a joint compare with: 1 rad, or half the size of the robot.
  double unit(int joint) const { return isHinge(joints_[joint]) ? 1.0 : 0.5 * size_; }

  /// Pose 0 of the file, within the limits.
  VectorXd zero() const {
    return coupled(Eigen::Map<const VectorXd>(model_->get().qpos0, model_->get().njnt));
  }

  VectorXd draw(std::mt19937_64* engine) const {
    VectorXd position(static_cast<Eigen::Index>(joints_.size()));
    for (Eigen::Index i = 0; i < position.size(); ++i) {
      const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
      position[i] =
          std::uniform_real_distribution<double>(joint.shown_lower, joint.shown_upper)(*engine);
    }
    return coupled(position);
  }

  /// Within the limits, and with the positions of joints that follow others.
  VectorXd coupled(VectorXd position) const {
    const mjModel& m = model_->get();
    for (int i = 0; i < m.neq; ++i) {
      if (m.eq_type[i] != mjEQ_JOINT || !m.eq_active[i]) continue;
      const int follower = m.eq_obj1id[i], leader = m.eq_obj2id[i];
      const mjtNum* const c = m.eq_data + mjNEQDATA * i;
      const double x = leader < 0 ? 0.0 : position[leader] - m.qpos0[leader];
      position[follower] =
          m.qpos0[follower] + c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * c[4])));
    }
    for (Eigen::Index i = 0; i < position.size(); ++i) {
      const ModelJoint& joint = joints_[static_cast<std::size_t>(i)];
      if (joint.limited) position[i] = std::clamp(position[i], joint.lower, joint.upper);
    }
    return position;
  }

  /// The model at rest in this pose.
  const mjData& place(const VectorXd& position) const {
    std::copy_n(position.data(), position.size(), data_->qpos);
    std::fill_n(data_->qvel, position.size(), 0.0);
    mj_fwdPosition(&model_->get(), data_.get());
    return *data_;
  }

  /// Torque that weight and springs ask for at rest: the gradient of energy().           [n x 1]
  VectorXd load(const VectorXd& position, bool springs = true) const {
    place(position);
    mj_fwdVelocity(&model_->get(), data_.get());
    VectorXd load = Eigen::Map<const VectorXd>(data_->qfrc_bias, position.size());
    if (springs) load -= Eigen::Map<const VectorXd>(data_->qfrc_passive, position.size());
    return load;
  }

  bool hasSprings() const {
    const mjModel& m = model_->get();
    const auto pulls = [](mjtNum stiffness) { return stiffness != 0.0; };
    return std::any_of(m.jnt_stiffness, m.jnt_stiffness + m.njnt, pulls) ||
           std::any_of(m.tendon_stiffness, m.tendon_stiffness + m.ntendon, pulls);
  }

  /// Of weight and springs [J].
  double energy(const VectorXd& position, bool springs = true) const {
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

  /// Inertia that a motor of this joint feels [kg m^2, kg].
  double inertia(int joint, const VectorXd& position) const {
    place(position);
    return data_->qM[model_->get().dof_Madr[joint]];
  }

  /// Where the mechanism goes by its weight and springs if it is slow.
  VectorXd settled(VectorXd position) const { return followed(std::move(position), -1.0); }

  /// The pose of the most energy that weight gives.
  VectorXd highest(const std::vector<VectorXd>& poses) const {
    const auto less = [this](const VectorXd& a, const VectorXd& b) {
      return energy(a, false) < energy(b, false);
    };
    return followed(*std::max_element(poses.begin(), poses.end(), less), 1.0);
  }

 private:
  /// Follows the energy down (sign -1) or up (1). Up, that of springs would have no end.
  VectorXd followed(VectorXd position, double sign) const {
    const bool springs = sign < 0.0;
    double step = 0.1, best = sign * energy(position, springs);
    for (int i = 0; i < 1000 && step > 1e-6; ++i) {
      VectorXd change = sign * load(position, springs);
      for (Eigen::Index k = 0; k < change.size(); ++k) {
        change[k] /= std::max(1e-12, inertia(static_cast<int>(k), position));
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

  /// The side of the space that the robot needs without its slides is its size. Slides that are much
  /// longer, or endless, would make the robot tiny in the image.
  void showSlidesInPart() {
    std::mt19937_64 engine(0);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
    for (int i = 0; i < kNumPoses; ++i) {
      VectorXd position = draw(&engine);
      for (std::size_t k = 0; k < joints_.size(); ++k) {
        if (!isHinge(joints_[k])) position[static_cast<Eigen::Index>(k)] = model_->get().qpos0[k];
      }
      const Eigen::Matrix3Xd corners = movingCorners(*model_, place(position));
      if (corners.cols() == 0) continue;
      low = low.cwiseMin(corners.rowwise().minCoeff());
      high = high.cwiseMax(corners.rowwise().maxCoeff());
    }
    size_ = std::max(1e-3, (high - low).maxCoeff());
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      ModelJoint& joint = joints_[k];
      const double wide = joint.upper - joint.lower;
      if (isHinge(joint) || (joint.limited && wide <= kWideSlide * size_)) continue;
      const double zero = std::clamp<double>(model_->get().qpos0[k], joint.lower, joint.upper);
      joint.shown_lower = joint.limited ? std::max(joint.lower, zero - size_) : zero - size_;
      joint.shown_upper = joint.limited ? std::min(joint.upper, zero + size_) : zero + size_;
      if (!joint.limited) {
        joint.lower = joint.shown_lower;
        joint.upper = joint.shown_upper;
      }
    }
  }

  std::shared_ptr<const MujocoModel> model_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
  std::vector<ModelJoint> joints_;
  double size_ = 1.0;  // [m]
};

VectorXd atRest(const VectorXd& position) {
  VectorXd state = VectorXd::Zero(2 * position.size());
  state.head(position.size()) = position;
  return state;
}

std::vector<double> listOf(const VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

/// Fills in a proposal, key by key.
class Proposer {
 public:
  Proposer(const std::shared_ptr<const MujocoModel>& model, const MotorChoice& choice)
      : model_(model), mechanism_(model) {
    out_.joints = mechanism_.joints();
    out_.options.model = model->uri();
    if (!choice.by_actuators) out_.options.motors = choice.joints;
    out_.options.max_torque = {1.0};  // until it is known
    motors_ = motorsOf(*model, out_.options);
    for (const Motor& motor : motors_) {
      out_.joints[static_cast<std::size_t>(motor.joint)].effort =
          motor.limit.value_or(0.0) * std::abs(motor.gear);
    }
    out_.reasons["motors"] = choice.why;
    std::mt19937_64 engine(1);
    for (int i = 0; i < kNumPoses; ++i) positions_.push_back(mechanism_.draw(&engine));
    for (const VectorXd& position : positions_) out_.poses.push_back(atRest(position));
  }

  PlantProposal propose(const std::vector<double>& max_torque) {
    proposeStartAndGoal();
    proposeTorque(max_torque);
    proposeTimeStep(max_torque.empty());
    proposeSuccess();
    proposeCamera();
    return out_;
  }

 private:
  bool gravityMatters() const {
    double least = 1e300, most = -1e300, load = 0.0;
    for (const VectorXd& position : positions_) {
      const double energy = mechanism_.energy(position, false);
      least = std::min(least, energy);
      most = std::max(most, energy);
      load = std::max(load, mechanism_.load(position, false).lpNorm<Eigen::Infinity>());
    }
    return most - least > 1e-6 * std::max(1.0, std::abs(most)) && load > 1e-9;
  }

  void proposeStartAndGoal() {
    const VectorXd zero = mechanism_.zero();
    const bool gravity = gravityMatters();
    const bool settles = gravity || mechanism_.hasSprings();
    const VectorXd rest =
        settles ? mechanism_.settled(mechanism_.coupled(zero.array() + 0.02)) : zero;
    VectorXd start = rest, goal = rest;
    if (gravity) {
      std::vector<VectorXd> candidates = positions_;
      for (VectorXd& one : candidates) {  // a joint that weight does not move stays where it starts
        const VectorXd load = mechanism_.load(one, false);
        for (Eigen::Index i = 0; i < one.size(); ++i) {
          if (std::abs(load[i]) < 1e-9) one[i] = rest[i];
        }
      }
      goal = mechanism_.highest(candidates);
    }
    out_.options.start_std.clear();
    for (int k = 0; k < 2; ++k) {
      for (std::size_t i = 0; i < out_.joints.size(); ++i) {
        out_.options.start_std.push_back(rounded(kStartStd * mechanism_.unit(static_cast<int>(i))));
      }
    }
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      const ModelJoint& joint = out_.joints[static_cast<std::size_t>(i)];
      const double inside = std::min(2.0 * out_.options.start_std[static_cast<std::size_t>(i)],
                                     0.1 * (joint.upper - joint.lower));
      for (double* value : {&start[i], &goal[i]}) {
        if (joint.limited) *value = std::clamp(*value, joint.lower + inside, joint.upper - inside);
        *value = roundedPosition(*value, isHinge(joint));
      }
    }
    start = mechanism_.coupled(start);
    goal = mechanism_.coupled(goal);
    bool upright = (goal - start).lpNorm<Eigen::Infinity>() > 0.1 * smallestUnit();
    if (!upright) goal = elsewhere(start);
    out_.options.start = listOf(start);
    out_.options.goal = listOf(goal);
    out_.reasons["start"] = settles ? "where the mechanism comes to rest by its weight and springs"
                                    : "pose 0 of the file";
    out_.reasons["goal"] = upright ? "Proposed: the highest pose"
                                   : "Proposed: the motors' joints a quarter of their way on";
    out_.to_set.push_back("goal");
  }

  double smallestUnit() const {
    double unit = 1.0;
    for (std::size_t i = 0; i < out_.joints.size(); ++i) {
      unit = std::min(unit, mechanism_.unit(static_cast<int>(i)));
    }
    return unit;
  }

  /// The motors' joints a quarter of their way from here.
  VectorXd elsewhere(VectorXd position) const {
    for (const Motor& motor : motors_) {
      const ModelJoint& joint = out_.joints[static_cast<std::size_t>(motor.joint)];
      const double quarter = 0.25 * (joint.shown_upper - joint.shown_lower);
      double& value = position[motor.joint];
      value += joint.limited && value + quarter > joint.shown_upper ? -quarter : quarter;
      value = roundedPosition(value, isHinge(joint));
    }
    return mechanism_.coupled(position);
  }

  /// What lifts the weight and accelerates the joint.
  double neededTorque(const Motor& motor) const {
    const mjModel& m = model_->get();
    double load = 0.0, inertia = 0.0;
    for (const VectorXd& position : positions_) {
      load = std::max(load, std::abs(mechanism_.load(position)[motor.joint]));
      inertia = std::max(inertia, mechanism_.inertia(motor.joint, position));
    }
    const double unit = mechanism_.unit(motor.joint);
    return (1.5 * load + kAcceleration * unit * inertia + m.dof_frictionloss[motor.joint] +
            2.0 * unit * m.dof_damping[motor.joint]) /
           std::abs(motor.gear);
  }

  void proposeTorque(const std::vector<double>& given) {
    std::vector<double>& limits = out_.options.max_torque;
    if (!given.empty()) {
      limits = given;
      limits = limitsOf(*model_, out_.options);
      out_.reasons["max_torque"] = "as given";
      return;
    }
    limits.clear();
    std::vector<std::string> reasons;
    for (const Motor& motor : motors_) {
      const double needed = rounded(neededTorque(motor));
      const std::string joint = model_->name(mjOBJ_JOINT, motor.joint);
      const double allowed = motor.limit.value_or(0.0);  // 0 in many files where it is not known
      if (allowed > 0.0 && allowed <= kTooStrong * needed) {
        limits.push_back(allowed);
        reasons.push_back(joint + ": limit of the file");
        continue;
      }
      limits.push_back(needed);
      reasons.push_back(joint + ": estimated from weight and inertia, because the file " +
                        (allowed > 0.0
                             ? "allows " + shortText(allowed) + ", far more than the joint needs"
                             : "has no limit"));
      if (allowed == 0.0 && out_.to_set.back() != "max_torque") out_.to_set.push_back("max_torque");
    }
    out_.reasons["max_torque"] = join(reasons, "; ");
  }

  /// Speeds of the fastest joint, in units of the joints, sorted.
  std::vector<double> speeds() const {
    const MujocoPhysics physics(model_, out_.options);
    const int n = physics.numJoints();
    const double timestep = timestepOf(*model_, out_.options);
    const int hold = std::max(1, static_cast<int>(std::round(kHold / timestep)));
    std::vector<double> speeds;
    std::mt19937_64 engine(2);
    for (int run = 0; run < 8; ++run) {
      VectorXd state = atRest(Eigen::Map<const VectorXd>(
          (run % 2 == 0 ? out_.options.start : out_.options.goal).data(), n));
      for (double time = 0.0; time < kSeconds; time += hold * timestep) {
        VectorXd torque(static_cast<Eigen::Index>(motors_.size()));
        for (Eigen::Index i = 0; i < torque.size(); ++i) {
          const double limit = out_.options.max_torque[static_cast<std::size_t>(i)];
          torque[i] = std::uniform_real_distribution<double>(-limit, limit)(engine);
        }
        const Eigen::MatrixXd states = physics.frames(state, torque, hold);
        for (Eigen::Index k = 0; k < states.cols(); ++k) {
          double fastest = 0.0;
          for (int i = 0; i < n; ++i) {
            fastest = std::max(fastest, std::abs(states(n + i, k)) / mechanism_.unit(i));
          }
          speeds.push_back(fastest);
        }
        state = states.rightCols(1);
      }
    }
    std::sort(speeds.begin(), speeds.end());
    return speeds;
  }

  /// With a smaller time step of the physics where that of the file is unstable.
  std::vector<double> stableSpeeds() {
    constexpr int kHalvings = 4;
    for (int i = 0; i < kHalvings; ++i) {
      try {
        return speeds();
      } catch (const std::range_error&) {
        out_.options.timestep = 0.5 * timestepOf(*model_, out_.options);
        out_.reasons["timestep"] = "with that of the file the simulation is unstable";
      }
    }
    return speeds();
  }

  /// @param free_torque  whether the torque may be lowered where it makes the joints too fast
  void proposeTimeStep(bool free_torque) {
    double fast = 0.0;
    for (int i = 0; i < 8; ++i) {
      const std::vector<double> all = stableSpeeds();
      fast = all[all.size() * 95 / 100];
      if (fast <= kFastest || !free_torque) break;
      for (double& limit : out_.options.max_torque) limit = rounded(0.5 * limit);
      out_.reasons["max_torque"] +=
          i > 0 ? "" : "; lowered, because random torques made it too fast";
    }
    const double timestep = timestepOf(*model_, out_.options);
    double dt = 0.02;
    for (const double nice : {0.04, 0.05, 0.1, 0.2}) {
      if (nice * fast <= kStep) dt = nice;
    }
    const double frames = std::max(1.0, std::floor(dt / timestep + 1e-6));
    out_.options.dt = std::max(timestep * frames, timestep * std::ceil(1e-3 / timestep));
    out_.reasons["dt"] = "under random torques and in a fall the fastest joint moves by up to " +
                         shortText(fast * out_.options.dt, "%.2g") +
                         " rad (slides: half sizes of the robot) between two images";
  }

  void proposeSuccess() {
    std::vector<std::string> hinges, slides;
    double shortest = 1e300;
    out_.feature_dim = 0;
    for (const ModelJoint& joint : out_.joints) {
      (isHinge(joint) ? hinges : slides).push_back(joint.name);
      if (!isHinge(joint)) shortest = std::min(shortest, joint.shown_upper - joint.shown_lower);
      out_.feature_dim += joint.turnsFar() ? 2 : 1;
    }
    out_.feature_dim = std::max(2, out_.feature_dim);
    out_.options.tolerance = hinges.empty() ? rounded(0.05 * shortest) : 10.0;
    if (!hinges.empty() && !slides.empty()) {
      out_.options.error_joints = hinges;
      out_.reasons["error_joints"] = "the positions of " + join(slides, ", ") + " do not count";
    }
    out_.to_set.push_back("tolerance");
  }

  /// The poses, start and goal, and each pose with all joints that have limits at the nearer one: no
  /// pose reaches farther.
  std::vector<VectorXd> withLimits() const {
    std::vector<VectorXd> poses = positions_;
    for (VectorXd position : positions_) {
      for (std::size_t i = 0; i < out_.joints.size(); ++i) {
        const ModelJoint& joint = out_.joints[i];
        if (!joint.limited) continue;
        double& value = position[static_cast<Eigen::Index>(i)];
        const bool low = value - joint.shown_lower < joint.shown_upper - value;
        value = low ? joint.shown_lower : joint.shown_upper;
      }
      poses.push_back(mechanism_.coupled(position));
    }
    for (const std::vector<double>* pose : {&out_.options.start, &out_.options.goal}) {
      poses.push_back(Eigen::Map<const VectorXd>(pose->data(), positions_[0].size()));
    }
    return poses;
  }

  void proposeCamera() {
    MujocoOptions& options = out_.options;
    options.look.supersampling = 4;
    const std::vector<CameraPlace> places = cameraPlaces(
        *model_,
        [this](const VectorXd& position) -> const mjData& { return mechanism_.place(position); },
        withLimits(), options.look.field_of_view);
    double best = -1.0;
    for (const CameraPlace& place : places) {
      RenderOptions look = options.look;
      look.position = listOf(place.position);
      look.look_at = listOf(place.look_at);
      const double shown = changeOfImages(look);
      if (shown <= 1.1 * best) continue;  // the more usual direction comes first
      best = shown;
      options.look = look;
    }
  }

  /// Mean over the pixels of how much each differs between poses.
  double changeOfImages(RenderOptions look) const {
    constexpr int kPoses = 8;
    Renderer renderer(model_->share(), look, out_.options.scene);
    Eigen::ArrayXd sum, squares;
    for (int i = 0; i < kPoses; ++i) {
      const Picture picture =
          renderer.draw(mechanism_.place(positions_[static_cast<std::size_t>(i)]));
      const Eigen::ArrayXd pixels =
          Eigen::Map<const Eigen::Array<std::uint8_t, Eigen::Dynamic, 1>>(
              picture.bytes.data(), static_cast<Eigen::Index>(picture.bytes.size()))
              .cast<double>();
      sum = i == 0 ? pixels : (sum + pixels).eval();
      squares = i == 0 ? pixels.square().eval() : (squares + pixels.square()).eval();
    }
    return (squares / kPoses - (sum / kPoses).square()).max(0.0).sqrt().mean();
  }

  std::shared_ptr<const MujocoModel> model_;
  Mechanism mechanism_;
  std::vector<Motor> motors_;
  std::vector<VectorXd> positions_;
  PlantProposal out_;
};

}  // namespace

std::vector<ModelJoint> jointsOf(const std::shared_ptr<const MujocoModel>& model) {
  std::vector<ModelJoint> joints = Mechanism(model).joints();
  for (ModelJoint& joint : joints) joint.effort = model->effortLimit(joint.name).value_or(0.0);
  return joints;
}

std::vector<std::string> transmissionJoints(const std::string& text) {
  const XmlDocument document = parseXml(text);
  const tinyxml2::XMLElement* const root = document->RootElement();
  std::vector<std::string> names;
  for (const auto* one = root->FirstChildElement("transmission"); one != nullptr;
       one = one->NextSiblingElement("transmission")) {
    const tinyxml2::XMLElement* const joint = one->FirstChildElement("joint");
    if (joint != nullptr) names.push_back(attribute(*joint, "name"));
  }
  return names;
}

MotorChoice chooseMotors(const MujocoModel& model, const std::vector<ModelJoint>& joints,
                         const std::vector<std::string>& transmissions) {
  const mjModel& m = model.get();
  MotorChoice choice;
  std::vector<std::string> with_effort;
  for (const ModelJoint& joint : joints) {
    if (!model.leaderOf(joint.name).empty()) continue;  // has no motor of its own
    choice.candidates.push_back(joint.name);
    if (joint.effort > 0.0) with_effort.push_back(joint.name);
  }
  /// @return whether these decide it: one or two different joints of the model
  const auto decide = [&choice](const std::vector<std::string>& names, const std::string& why) {
    std::vector<std::string> chosen;
    for (const std::string& name : names) {
      const auto in = [&name](const std::vector<std::string>& all) {
        return std::count(all.begin(), all.end(), name) > 0;
      };
      if (in(choice.candidates) && !in(chosen)) chosen.push_back(name);
    }
    if (chosen.empty() || chosen.size() > kMaxMotors) return false;
    choice.joints = chosen;
    choice.why = why;
    return true;
  };
  if (m.nu > 0) {
    std::vector<std::string> names;
    for (int i = 0; i < m.nu; ++i) {
      if (m.actuator_trntype[i] != mjTRN_JOINT) continue;
      names.push_back(model.name(mjOBJ_JOINT, m.actuator_trnid[2 * i]));
    }
    try {
      const bool plain = !motorsOf(model, MujocoOptions()).empty();
      choice.by_actuators = decide(names, "the motors of the file") && plain;
    } catch (const std::invalid_argument& e) {
      decide(names, std::string("joints of the file's actuators, which are off: ") + e.what());
    }
    return choice;
  }
  if (decide(transmissions, "joints of the transmissions in the file") ||
      decide(with_effort, "joints with an effort limit in the file") ||
      choice.candidates.size() != 1) {
    return choice;
  }
  decide(choice.candidates, "the only joint");
  return choice;
}

PlantProposal proposePlant(const std::shared_ptr<const MujocoModel>& model,
                           const MotorChoice& choice, const std::vector<double>& max_torque) {
  return Proposer(model, choice).propose(max_torque);
}

PlantCheck checkPlant(const PlantProposal& proposal, Plant* plant) {
  constexpr int kPoses = 12, kTrials = 5, kTrialSteps = 100, kHoldSteps = 3, kVisible = 8;
  PlantCheck check;
  const auto n = static_cast<Eigen::Index>(proposal.joints.size());
  const VectorXd start = plant->info().start;
  const int steps = std::max(1, static_cast<int>(std::round(kSeconds / plant->info().dt)));
  plant->setState(start);
  for (int i = 0; i < steps; ++i) {
    plant->step(VectorXd::Zero(plant->torqueDim()));
    check.still_speed =
        std::max(check.still_speed, plant->state().tail(n).lpNorm<Eigen::Infinity>());
  }
  std::mt19937_64 engine(3);
  int outside = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    plant->setState(plant->drawStart(engine));
    VectorXd torque(plant->torqueDim());
    for (int i = 0; i < std::max(kTrialSteps, steps); ++i) {
      for (Eigen::Index k = 0; i % kHoldSteps == 0 && k < torque.size(); ++k) {
        const double limit = plant->info().max_torque[k];
        torque[k] = std::uniform_real_distribution<double>(-limit, limit)(engine);
      }
      plant->step(torque);
      check.random_speed =
          std::max(check.random_speed, plant->state().tail(n).lpNorm<Eigen::Infinity>());
      bool beyond = false;
      for (Eigen::Index k = 0; k < n; ++k) {
        const ModelJoint& joint = proposal.joints[static_cast<std::size_t>(k)];
        if (isHinge(joint)) continue;
        const double margin = 0.05 * (joint.shown_upper - joint.shown_lower);
        beyond = beyond || plant->state()[k] < joint.shown_lower - margin ||
                 plant->state()[k] > joint.shown_upper + margin;
      }
      outside += beyond ? 1 : 0;
    }
  }
  check.share_outside = static_cast<double>(outside) / (kTrials * std::max(kTrialSteps, steps));

  const auto change = [&](const VectorXd& a, const VectorXd& b) {  // pixels, largest
    const Picture first = plant->render(a), second = plant->render(b);
    std::pair<int, int> out = {0, 0};
    for (std::size_t i = 0; i < first.bytes.size(); ++i) {
      const int difference = std::abs(first.bytes[i] - second.bytes[i]);
      out.first += difference >= kVisible ? 1 : 0;
      out.second = std::max(out.second, difference);
    }
    return out;
  };
  std::vector<int> pixels;
  for (std::size_t i = 0; i + 1 < kPoses; ++i) {
    const std::pair<int, int> here = change(proposal.poses[i], proposal.poses[i + 1]);
    pixels.push_back(here.first);
    check.contrast = std::max(check.contrast, here.second);
  }
  std::nth_element(pixels.begin(), pixels.begin() + kPoses / 2, pixels.end());
  check.changed_pixels = pixels[kPoses / 2];
  for (Eigen::Index k = 0; k < n; ++k) {
    const ModelJoint& joint = proposal.joints[static_cast<std::size_t>(k)];
    int seen = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      VectorXd moved = proposal.poses[i];
      const double quarter = 0.25 * (joint.shown_upper - joint.shown_lower);
      moved[k] += moved[k] + quarter > joint.shown_upper ? -quarter : quarter;
      seen = std::max(seen, change(proposal.poses[i], moved).first);
    }
    if (seen == 0) check.unseen.push_back(joint.name);
  }
  return check;
}

}  // namespace ddm
