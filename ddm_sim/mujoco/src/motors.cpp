// The motors of a model: which joints, how strong.
// SPDX-License-Identifier: BSD-3-Clause
#include "motors.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "ddm_mujoco/plant_proposal.h"
#include "xml_text.h"

namespace ddm {
namespace {

constexpr std::size_t kMaxMotors = 2;  // without being asked for more

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

/// Torque at the joint for a control of 1 of actuator `i`; 0 if its torque is not just a multiple of
/// its control.
double strengthOf(const mjModel& m, int i) {
  const bool plain = m.actuator_trntype[i] == mjTRN_JOINT && m.actuator_dyntype[i] == mjDYN_NONE &&
                     m.actuator_gaintype[i] == mjGAIN_FIXED &&
                     m.actuator_biastype[i] == mjBIAS_NONE;
  return plain ? m.actuator_gear[6 * i] * m.actuator_gainprm[mjNGAIN * i] : 0.0;
}

/// What the actuators of the file can do at a joint in both directions [N m or N]; none if there is
/// none, or one of them has no limit.
std::optional<double> limitOfActuators(const mjModel& m, int joint) {
  double low = 0.0, high = 0.0;
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] != mjTRN_JOINT || m.actuator_trnid[2 * i] != joint) continue;
    const double endless = std::numeric_limits<double>::infinity();
    double least = -endless, most = endless;
    const auto bound = [&](const mjtNum* range, double unit) {
      least = std::max(least, std::min(range[0] * unit, range[1] * unit));
      most = std::min(most, std::max(range[0] * unit, range[1] * unit));
    };
    const double strength = strengthOf(m, i);
    if (m.actuator_ctrllimited[i] && strength != 0.0) {
      bound(&m.actuator_ctrlrange[2 * i], strength);
    }
    if (m.actuator_forcelimited[i]) {
      bound(&m.actuator_forcerange[2 * i], m.actuator_gear[6 * i]);
    }
    low += least;
    high += most;
  }
  const double limit = std::min(-low, high);
  return limit > 0.0 && std::isfinite(limit) ? std::make_optional(limit) : std::nullopt;
}

/// Actuator `i` of the file, if its torque is nothing but a multiple of its control.
Motor actuator(const MujocoModel& model, int i) {
  const mjModel& m = model.get();
  const double strength = strengthOf(m, i);
  if (strength == 0.0) {
    throw std::invalid_argument("actuator " + model.name(mjOBJ_ACTUATOR, i) + " of " + model.uri() +
                                " must be a <motor> of a joint: make it one, or list the joints "
                                "that have a motor in plant/motors");
  }
  Motor motor;
  motor.joint = m.actuator_trnid[2 * i];
  const auto bound = [&](const char* name, const mjtNum* range, double unit) {
    if (range[0] != -range[1]) {
      throw std::invalid_argument(
          "actuator " + model.name(mjOBJ_ACTUATOR, i) + " of " + model.uri() + " has the " + name +
          " [" + text(range[0]) + ", " + text(range[1]) +
          "]: it must be symmetric about 0, as plant/max_torque is; make it so, or list the joint "
          "in "
          "plant/motors and give plant/max_torque, which leaves this actuator switched off");
    }
    const double limit = std::abs(range[1]) * unit;
    motor.limit = std::min(motor.limit.value_or(limit), limit);
  };
  if (m.actuator_ctrllimited[i]) {
    bound("ctrlrange", &m.actuator_ctrlrange[2 * i], std::abs(strength));
  }
  if (m.actuator_forcelimited[i]) {
    bound("forcerange", &m.actuator_forcerange[2 * i], std::abs(m.actuator_gear[6 * i]));
  }
  return motor;
}

std::string nameOf(const MujocoModel& model, const Motor& motor) {
  return model.name(mjOBJ_JOINT, motor.joint);
}

void requireDifferentJoints(const MujocoModel& model, const std::vector<Motor>& motors) {
  for (auto motor = motors.begin(); motor != motors.end(); ++motor) {
    const auto same = [motor](const Motor& other) { return other.joint == motor->joint; };
    if (std::none_of(motors.begin(), motor, same)) continue;
    throw std::invalid_argument("plant/motors must differ, got two for the joint " +
                                nameOf(model, *motor) + " of " + model.uri());
  }
}

}  // namespace

std::vector<Motor> motorsOf(const MujocoModel& model, const MujocoOptions& options) {
  std::vector<Motor> motors;
  if (options.motors.empty()) {
    for (int i = 0; i < model.get().nu; ++i) motors.push_back(actuator(model, i));
  }
  for (const std::string& name : options.motors) {
    Motor motor;
    motor.joint = model.id(mjOBJ_JOINT, name, "plant/motors");
    const std::string leader = model.leaderOf(name);
    if (!leader.empty()) {
      throw std::invalid_argument("plant/motors must list joints that move by themselves, got " +
                                  name + " of " + model.uri() + ", which mimics the joint " +
                                  leader + ": list that one");
    }
    motor.limit = model.effortLimit(name);
    if (!motor.limit) motor.limit = limitOfActuators(model.get(), motor.joint);
    motors.push_back(motor);
  }
  if (model.get().njnt == 0) {
    throw std::invalid_argument("plant/model must have a joint that moves, got none in " +
                                model.uri());
  }
  if (motors.empty()) {
    std::string joints;
    for (const std::string& joint : model.names(mjOBJ_JOINT)) {
      joints += (joints.empty() ? "" : ", ") + joint;
    }
    throw std::invalid_argument("plant/motors must list the joints that have a motor, since " +
                                model.uri() + " has none: there are " + joints);
  }
  requireDifferentJoints(model, motors);
  return motors;
}

std::vector<double> limitsOf(const MujocoModel& model, const MujocoOptions& options) {
  const std::vector<Motor> motors = motorsOf(model, options);
  const std::vector<double>& given = options.max_torque;
  if (given.size() > 1 && given.size() != motors.size()) {
    throw std::invalid_argument("plant/max_torque must be one number, or one for each of the " +
                                std::to_string(motors.size()) + " motors, got " +
                                std::to_string(given.size()));
  }
  std::vector<double> limits;
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const Motor& motor = motors[i];
    const std::string joint = nameOf(model, motor);
    if (given.empty() && motor.limit.value_or(0.0) == 0.0) {
      throw std::invalid_argument(
          "plant/max_torque must be given, because " + model.uri() +
          (motor.limit ? " has a limit of 0" : " has no limit") + " for the motor of the joint " +
          joint +
          ": write it there, or give the joint an effort (URDF) or the motor a ctrlrange (MJCF)");
    }
    const double limit = given.empty() ? *motor.limit : given[given.size() == 1 ? 0 : i];
    // Files that were made by a drawing program often say effort 0 for what is not known.
    if (motor.limit.value_or(0.0) > 0.0 && limit > *motor.limit * (1.0 + 1e-9)) {
      throw std::invalid_argument("plant/max_torque must be at most what " + model.uri() +
                                  " allows, " + text(*motor.limit) + " at the joint " + joint +
                                  ", got " + text(limit));
    }
    limits.push_back(limit);
  }
  return limits;
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

}  // namespace ddm
