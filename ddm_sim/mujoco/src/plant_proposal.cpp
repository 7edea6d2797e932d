// Proposes plant options for a model file that has no plant file yet.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/plant_proposal.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <iomanip>
#include <random>
#include <stdexcept>

#include "ddm_sim/plant.h"
#include "mechanism.h"
#include "motors.h"
#include "mujoco_physics.h"

namespace ddm {
namespace {

using boost::algorithm::join;
using Eigen::VectorXd;
using Texts = std::vector<std::string>;

constexpr int kNumPoses = 200;  // poses that the camera has to see
// Acceleration by a proposed torque [rad/s^2], slides [sizes/s^2]
constexpr double kAcceleration = 10;
constexpr double kTooStrong = 4.0;  // a file's limit above this many proposed torques is not used
// Largest motion between two images for the choice of dt [rad]
constexpr double kStep = 0.8;
// Largest speed, so that dt >= 0.02 s, the period of a usual camera [rad/s]
constexpr double kFastest = 40.0;
constexpr double kStartStd = 0.1;  // largest standard deviation of the initial state [rad]
// Largest standard deviation of the initial state, as a share of the joint's range
constexpr double kStartShare = 0.05;

/// Rounds to two significant digits.
double rounded(double number) { return std::stod(textOf(std::setprecision(2), number)); }

/// Rounds angles near a multiple of pi/2 to that multiple, and all other positions to three
/// decimals.
double roundedPosition(double position, bool angle) {
  const double quarters = std::round(position / (0.5 * kPi));
  if (angle && std::abs(position - 0.5 * kPi * quarters) < 3e-3) return 0.5 * kPi * quarters;
  return std::round(position * 1e3) / 1e3 + 0.0;  // + 0.0 turns -0 into 0
}

std::vector<double> listOf(const VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

/// Computes the keys of a proposal one after the other.
class Proposer {
 public:
  Proposer(const std::shared_ptr<const MujocoModel>& model, const Texts& motors)
      : model_(model), mechanism_(model) {
    out_.joints = mechanism_.joints();
    const MotorChoice choice =
        motors.empty() ? chosenMotors(*model, out_.joints) : MotorChoice{motors, "as given"};
    out_.options.model = model->uri();
    if (!choice.by_actuators) out_.options.motors = choice.joints;
    out_.options.max_torque = {1.0};  // placeholder until proposeTorque()
    motors_ = motorsOf(*model, out_.options);
    for (const Motor& motor : motors_) {
      ModelJoint& joint = out_.joints[static_cast<std::size_t>(motor.joint)];
      joint.effort = motor.limit;
      out_.motors.push_back(joint.name);
    }
    out_.reasons["motors"] = choice.why;
    std::mt19937_64 engine(1);
    for (int i = 0; i < kNumPoses; ++i) positions_.push_back(mechanism_.draw(&engine));
    for (const VectorXd& position : positions_) out_.poses.push_back(atRest(position));
  }

  PlantProposal propose(const std::vector<double>& max_torque) {
    requireNoEndlessFall();
    proposeStartAndGoal();
    proposeTorque(max_torque);
    proposeTimeStep(max_torque.empty());
    proposeSuccess();
    proposeCamera();
    return out_;
  }

 private:
  /// @throws std::invalid_argument naming a slide without limits that carries weight
  void requireNoEndlessFall() const {
    for (const VectorXd& position : positions_) {
      const VectorXd load = mechanism_.load(position, false);
      for (std::size_t i = 0; i < out_.joints.size(); ++i) {
        const int joint = static_cast<int>(i);
        const bool held = out_.joints[i].limited || out_.joints[i].isHinge() ||
                          mechanism_.follows(joint) || model_->get().jnt_stiffness[i] > 0.0;
        if (held || std::abs(load[joint]) < 1e-6) continue;
        refuseModel("the slide ", out_.joints[i].name, " of ", model_->uri(),
                    " carries weight and has no limits, so that it falls without end: give it a "
                    "range in the file");
      }
    }
  }

  void proposeStartAndGoal() {
    const VectorXd zero = mechanism_.zero();
    // Away from an unstable equilibrium.
    const VectorXd nudged = mechanism_.coupled(zero.array() + 0.02);
    VectorXd rest = mechanism_.settled(nudged);
    const bool settles = rest != nudged && !mechanism_.overlaps(rest);
    if (!settles) rest = zero;
    std::vector<VectorXd> candidates = {rest};
    for (VectorXd one : positions_) {  // a joint without load keeps its rest position
      const VectorXd load = mechanism_.load(one, false);
      for (Eigen::Index i = 0; i < one.size(); ++i) {
        if (std::abs(load[i]) < 1e-6) one[i] = rest[i];
      }
      if (!mechanism_.overlaps(one)) candidates.push_back(one);
    }
    VectorXd start = rest, goal = mechanism_.highest(candidates);
    const double lift = mechanism_.energy(goal, false) - mechanism_.energy(rest, false);
    if (lift < 1e-6 || mechanism_.overlaps(goal)) goal = rest;  // without gravity, lift is rounding
    std::vector<double>& start_std = out_.options.start_std;
    start_std.clear();
    for (std::size_t i = 0; i < out_.joints.size(); ++i) {
      const int joint = static_cast<int>(i);
      const double narrow = kStartShare * (out_.joints[i].upper - out_.joints[i].lower);
      const double largest = std::min(kStartStd * mechanism_.unit(joint), narrow);
      start_std.push_back(mechanism_.follows(joint) ? 0.0 : rounded(largest));
    }
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      const ModelJoint& joint = out_.joints[static_cast<std::size_t>(i)];
      const double inside = 2.0 * start_std[static_cast<std::size_t>(i)];
      for (double* value : {&start[i], &goal[i]}) {
        if (!joint.turnsFreely()) {
          *value = std::clamp(*value, joint.lower + inside, joint.upper - inside);
        }
        *value = roundedPosition(*value, joint.isHinge());
      }
    }
    // The rates get the same standard deviations.
    const std::vector<double> of_positions = start_std;
    start_std.insert(start_std.end(), of_positions.begin(), of_positions.end());
    start = mechanism_.coupled(start);
    goal = mechanism_.coupled(goal);
    bool upright = false;
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      const double far = 0.1 * mechanism_.unit(static_cast<int>(i));
      upright = upright || std::abs(goal[i] - start[i]) > far;
    }
    if (!upright) goal = elsewhere(start);
    out_.options.start = listOf(start);
    out_.options.goal = listOf(goal);
    out_.reasons["start"] = settles ? "where the mechanism comes to rest by its weight and springs"
                                    : "pose 0 of the file";
    out_.reasons["goal"] = upright ? "Proposed: the highest pose"
                                   : "Proposed: the motors' joints a quarter of their way on";
    out_.to_set.insert("goal");
  }

  /// Moves each motor's joint by a quarter of its range from this position.
  VectorXd elsewhere(VectorXd position) const {
    for (const Motor& motor : motors_) {
      const ModelJoint& joint = out_.joints[static_cast<std::size_t>(motor.joint)];
      const double quarter = 0.25 * (joint.upper - joint.lower);
      double& value = position[motor.joint];
      value += joint.limited && value + quarter > joint.upper ? -quarter : quarter;
      value = roundedPosition(value, joint.isHinge());
    }
    return mechanism_.coupled(position);
  }

  /// Torque that lifts the weight with a margin [N m or N].
  double liftingTorque(const Motor& motor) const {
    double load = 0.0;
    for (const VectorXd& position : positions_) {
      const VectorXd motion = mechanism_.motion(motor.joint, position);
      load = std::max(load, std::abs(motion.dot(mechanism_.load(position))));
    }
    return 1.5 * load;
  }

  /// Torque that lifts the weight and accelerates the joint [N m or N].
  double neededTorque(const Motor& motor) const {
    const mjModel& m = model_->get();
    double inertia = 0.0;
    for (const VectorXd& position : positions_) {
      const VectorXd motion = mechanism_.motion(motor.joint, position);
      inertia = std::max(inertia, mechanism_.inertia(motion, position));
    }
    const double unit = mechanism_.unit(motor.joint);
    return liftingTorque(motor) + kAcceleration * unit * inertia + m.dof_frictionloss[motor.joint] +
           2.0 * unit * m.dof_damping[motor.joint];
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
    Texts reasons;
    for (const Motor& motor : motors_) {
      const double needed = rounded(neededTorque(motor));
      const std::string joint = model_->name(mjOBJ_JOINT, motor.joint);
      const double allowed = motor.limit;
      if (allowed > 0.0 && allowed <= kTooStrong * needed) {
        limits.push_back(allowed);
        reasons.push_back(joint + ": limit of the file");
        continue;
      }
      limits.push_back(needed);
      reasons.push_back(joint + ": estimated from weight and inertia, because the file " +
                        (allowed > 0.0 ? textOf("allows ", std::setprecision(3), allowed,
                                                ", far more than the joint needs")
                                       : motor.why_unknown));
      if (allowed == 0.0) out_.to_set.insert("max_torque");
    }
    out_.reasons["max_torque"] = join(reasons, "; ");
  }

  /// Speed under random torques of up to this share of max_torque. Reduces the time step of the
  /// physics if the simulation is unstable.
  double stableSpeed(double share) {
    constexpr int kHalvings = 4;
    const auto speed = [&] {
      return mechanism_.speedUnderRandomTorques(out_.options, motors_.size(), share);
    };
    for (int i = 0; i < kHalvings; ++i) {
      try {
        return speed();
      } catch (const std::range_error&) {
        out_.options.timestep = 0.5 * timestepOf(*model_, out_.options);
        out_.reasons["timestep"] = "with that of the file the simulation is unstable";
      }
    }
    return speed();
  }

  /// @param free_torque  true: the torque may be lowered if it makes the joints too fast
  void proposeTimeStep(bool free_torque) {
    std::vector<double>& limits = out_.options.max_torque;
    const std::vector<double> first = limits;
    constexpr double kTip = 0.01;  // tips the robot out of its equilibrium
    const double fall = stableSpeed(kTip);
    double fast = stableSpeed(1.0);
    for (int i = 0; free_torque && i < 8 && fast > std::max(kFastest, 1.2 * fall); ++i) {
      for (std::size_t k = 0; k < limits.size(); ++k) {
        const double least = std::min(limits[k], rounded(liftingTorque(motors_[k])));
        limits[k] = std::max(least, rounded(0.5 * limits[k]));
      }
      fast = stableSpeed(1.0);
    }
    if (limits != first) {
      out_.to_set.insert("max_torque");
      out_.reasons["max_torque"] +=
          textOf("; lowered, because random torques made a joint faster than ", kFastest,
                 " rad/s (slides: sizes of the robot per s), faster than a fall");
    }
    const double timestep = timestepOf(*model_, out_.options);
    double dt = 0.02;
    for (const double nice : {0.04, 0.05, 0.1, 0.2}) {
      if (nice * fast <= kStep) dt = nice;
    }
    const double frames = std::max(1.0, std::floor(dt / timestep + 1e-6));
    out_.options.dt = std::max(timestep * frames, timestep * std::ceil(1e-3 / timestep));
    out_.reasons["dt"] = "under random torques and in a fall the fastest joint moves by up to " +
                         textOf(std::setprecision(2), fast * out_.options.dt) +
                         " rad (slides: sizes of the robot) between two images";
  }

  void proposeSuccess() {
    Texts slides;
    double shortest = 1e300;
    for (const ModelJoint& joint : out_.joints) {
      if (joint.isHinge()) continue;
      slides.push_back(joint.name);
      shortest = std::min(shortest, joint.upper - joint.lower);
    }
    const bool has_hinges = slides.size() < out_.joints.size();
    double tolerance = 10.0;
    for (const Motor& motor : motors_) {  // a narrow hinge must not be within it at the start
      const auto i = static_cast<std::size_t>(motor.joint);
      const ModelJoint& joint = out_.joints[i];
      const double way = std::abs(out_.options.goal[i] - out_.options.start[i]);
      const bool moves = joint.isHinge() && way > 0.1 * (joint.upper - joint.lower);
      if (moves) tolerance = std::min(tolerance, rounded(0.25 * way * 180.0 / kPi));
    }
    out_.options.tolerance = has_hinges ? tolerance : rounded(0.05 * shortest);
    if (has_hinges && !slides.empty()) {
      out_.reasons["tolerance"] = "the positions of " + join(slides, ", ") +
                                  " do not count; to measure sites or links, add error_sites";
    }
    out_.to_set.insert("tolerance");
  }

  /// The camera sees all proposed poses, initial state and goal. In addition, it sees each pose
  /// with all limited joints at their nearer limit, because no pose within the limits reaches
  /// farther.
  void proposeCamera() {
    std::vector<VectorXd> poses = positions_;
    for (const VectorXd& position : positions_) poses.push_back(mechanism_.atLimits(position));
    for (const std::vector<double>* pose : {&out_.options.start, &out_.options.goal}) {
      poses.push_back(Eigen::Map<const VectorXd>(pose->data(), positions_[0].size()));
    }
    out_.options.look.supersampling = 4;
    out_.options.look = placedCamera(model_, mechanism_, poses, out_.options.look);
  }

  std::shared_ptr<const MujocoModel> model_;
  Mechanism mechanism_;
  std::vector<Motor> motors_;
  std::vector<VectorXd> positions_;
  PlantProposal out_;
};

}  // namespace

PlantProposal proposePlant(const std::shared_ptr<const MujocoModel>& model, const Texts& motors,
                           const std::vector<double>& max_torque) {
  return Proposer(model, motors).propose(max_torque);
}

}  // namespace ddm
