// Finds the motors of a model, their joints and their limits.
// SPDX-License-Identifier: BSD-3-Clause
#include "motors.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

using Texts = std::vector<std::string>;

/// Range of an actuator's torque at its joint [N m or N]. Infinite if the file has no limit.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  /// Largest torque that the motor reaches in both directions; 0 if the torque has no limit.
  double limit() const {
    const double limit = std::min(-low, high);
    return limit > 0.0 && std::isfinite(limit) ? limit : 0.0;
  }

  /// Why limit() is 0.
  std::string whyNone() const {
    if (!(low < high) || !std::isfinite(high - low)) return "has no limit";
    return textOf("has the one-sided torques [", low, ", ", high, "]");
  }
};

/// Torque at the joint for a control of 1 of actuator `i`. The result is 0 if the torque is not
/// proportional to the control.
double strengthOf(const mjModel& m, int i) {
  const bool plain = m.actuator_trntype[i] == mjTRN_JOINT && m.actuator_dyntype[i] == mjDYN_NONE &&
                     m.actuator_gaintype[i] == mjGAIN_FIXED &&
                     m.actuator_biastype[i] == mjBIAS_NONE;
  return plain ? m.actuator_gear[6 * i] * m.actuator_gainprm[mjNGAIN * i] : 0.0;
}

Range rangeOf(const mjModel& m, int i) {
  Range range;
  const auto bound = [&range](const mjtNum* ends, double unit) {
    range.low = std::max(range.low, std::min(ends[0] * unit, ends[1] * unit));
    range.high = std::min(range.high, std::max(ends[0] * unit, ends[1] * unit));
  };
  const double strength = strengthOf(m, i);
  if (m.actuator_ctrllimited[i] && strength != 0.0) bound(m.actuator_ctrlrange + 2 * i, strength);
  if (m.actuator_forcelimited[i]) bound(m.actuator_forcerange + 2 * i, m.actuator_gear[6 * i]);
  return range;
}

/// Torques that all actuators of the file together reach at a joint. Infinite if one of them has no
/// limit.
Range rangeOfActuators(const mjModel& m, int joint) {
  Range sum = {0.0, 0.0};
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] != mjTRN_JOINT || m.actuator_trnid[2 * i] != joint) continue;
    const Range range = rangeOf(m, i);
    sum = {sum.low + range.low, sum.high + range.high};
  }
  return sum;
}

/// Actuator `i` of the file.
/// @throws std::invalid_argument if its torque is not proportional to its control
Motor actuator(const MujocoModel& model, int i) {
  const mjModel& m = model.get();
  const std::string name = "actuator " + model.name(mjOBJ_ACTUATOR, i) + " of " + model.uri();
  if (strengthOf(m, i) == 0.0) {
    refuseModel(name,
                " must be a <motor> of a joint: make it one, or list the joints that have a motor "
                "in plant/motors");
  }
  const Range range = rangeOf(m, i);
  if (range.low != -range.high) {
    refuseModel(name, " has the torques [", range.low, ", ", range.high,
                "] (ctrlrange and forcerange times gear): they must be symmetric about 0, as "
                "plant/max_torque is; make them so, or list the joint in plant/motors and give "
                "plant/max_torque, which leaves this actuator switched off");
  }
  return {m.actuator_trnid[2 * i], range.limit()};
}

Motor namedMotor(const MujocoModel& model, const std::string& name) {
  const int joint = model.id(mjOBJ_JOINT, name, "plant/motors");
  const auto follows = model.urdf().leaders.find(name);
  if (follows != model.urdf().leaders.end()) {
    refuseModel("plant/motors must list joints that move by themselves, got ", name, " of ",
                model.uri(), ", which mimics the joint ", follows->second, ": list that one");
  }
  if (const auto effort = model.effortLimit(name)) return {joint, *effort, "has a limit of 0"};
  const Range range = rangeOfActuators(model.get(), joint);
  return {joint, range.limit(), range.whyNone()};
}

}  // namespace

std::vector<Motor> motorsOf(const MujocoModel& model, const MujocoOptions& options) {
  std::vector<Motor> motors;
  for (int i = 0; options.motors.empty() && i < model.get().nu; ++i) {
    motors.push_back(actuator(model, i));
  }
  for (const std::string& name : options.motors) motors.push_back(namedMotor(model, name));
  if (motors.empty()) {
    refuseModel("plant/motors must list the joints that have a motor, since ", model.uri(),
                " has none: there are ", boost::algorithm::join(model.names(mjOBJ_JOINT), ", "));
  }
  std::set<int> joints;
  for (const Motor& motor : motors) {
    if (joints.insert(motor.joint).second) continue;
    refuseModel("plant/motors must differ, got two for the joint ",
                model.name(mjOBJ_JOINT, motor.joint), " of ", model.uri());
  }
  return motors;
}

std::vector<double> limitsOf(const MujocoModel& model, const MujocoOptions& options) {
  const std::vector<Motor> motors = motorsOf(model, options);
  const std::vector<double>& given = options.max_torque;
  if (given.size() > 1 && given.size() != motors.size()) {
    refuseModel("plant/max_torque must be one number, or one for each of the ", motors.size(),
                " motors, got ", given.size());
  }
  std::vector<double> limits;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const std::string joint = model.name(mjOBJ_JOINT, motors[i].joint);
    const double allowed = motors[i].limit;
    if (given.empty() && allowed == 0.0) {
      refuseModel(
          "plant/max_torque must be given, because ", model.uri(), " ", motors[i].why_unknown,
          " for the motor of the joint ", joint,
          ": write it there, or give the joint an effort (URDF) or the motor a symmetric ctrlrange "
          "(MJCF)");
    }
    const double limit = given.empty() ? allowed : given[given.size() == 1 ? 0 : i];
    constexpr double kRounding = 1e-6;  // new_plant writes seven digits
    if (allowed > 0.0 && limit > allowed * (1.0 + kRounding)) {
      refuseModel("plant/max_torque must be at most what ", model.uri(), " allows, ", allowed,
                  " at the joint ", joint, ", got ", limit);
    }
    limits.push_back(limit);
  }
  return limits;
}

MotorChoice chosenMotors(const MujocoModel& model, const std::vector<ModelJoint>& joints) {
  // Largest number of motors that are chosen without the option --motors.
  constexpr std::size_t kMaxMotors = 2;
  const mjModel& m = model.get();
  Texts candidates, with_effort, actuated;
  for (const ModelJoint& joint : joints) {
    // A joint that mimics another one has no motor.
    if (model.urdf().leaders.count(joint.name) > 0) continue;
    candidates.push_back(joint.name);
    if (joint.effort > 0.0) with_effort.push_back(joint.name);
  }
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] != mjTRN_JOINT) continue;
    actuated.push_back(model.name(mjOBJ_JOINT, m.actuator_trnid[2 * i]));
  }
  bool usable = true;
  std::string why = "the motors of the file";
  try {
    motorsOf(model, MujocoOptions());
  } catch (const std::invalid_argument& e) {
    usable = false;
    why = std::string("joints of the file's actuators, which are off: ") + e.what();
  }
  const MotorChoice choices[] = {
      {actuated, why, usable},
      {model.urdf().transmissions, "joints of the transmissions in the file"},
      {with_effort, "joints with an effort limit in the file"},
      {candidates.size() == 1 ? candidates : Texts(), "the only joint"}};
  for (MotorChoice choice : choices) {
    Texts chosen;
    for (const std::string& name : choice.joints) {
      const bool can_move = std::count(candidates.begin(), candidates.end(), name) > 0;
      const bool is_new = std::count(chosen.begin(), chosen.end(), name) == 0;
      if (can_move && is_new) chosen.push_back(name);
    }
    if (chosen.empty() || chosen.size() > kMaxMotors) continue;
    choice.joints = chosen;
    return choice;
  }
  refuseModel(
      "name the joints that have a motor, because the file does not say which one or two: "
      "--motors with some of ",
      boost::algorithm::join(candidates, ","));
}

}  // namespace ddm
