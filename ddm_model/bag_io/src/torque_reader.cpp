// Torques, whatever the message that carries them.
// SPDX-License-Identifier: BSD-3-Clause
#include "torque_reader.h"

#include <ddm_msgs/Torque.h>
#include <geometry_msgs/WrenchStamped.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <stdexcept>

#include "bag_file.h"

namespace ddm {
namespace {

std::string listOf(const std::vector<std::string>& names) {
  return names.empty() ? "nothing" : boost::algorithm::join(names, ", ");
}

bool anyIn(const std::vector<std::string>& names, const std::vector<std::string>& wanted) {
  return std::find_first_of(names.begin(), names.end(), wanted.begin(), wanted.end()) !=
         names.end();
}

}  // namespace

const std::vector<std::string>& TorqueReader::types() {
  static const std::vector<std::string> types = {
      "ddm_msgs/Torque",       "std_msgs/Float64",           "std_msgs/Float64MultiArray",
      "std_msgs/Float32",      "std_msgs/Float32MultiArray", "geometry_msgs/WrenchStamped",
      "sensor_msgs/JointState"};
  return types;
}

/// The values of motors_. Empty if none of them is among the names.
TorqueReader::Values TorqueReader::byName(const std::vector<std::string>& names,
                                          const Values& values, const std::string& topic) const {
  Values found;
  std::vector<std::string> missing;
  for (const std::string& motor : motors_) {
    const auto name = std::find(names.begin(), names.end(), motor);
    if (name == names.end()) {
      missing.push_back(motor);
    } else {
      found.push_back(values[static_cast<std::size_t>(name - names.begin())]);
    }
  }
  if (found.empty() || missing.empty()) return found;
  throw std::runtime_error("topic " + topic + " has " + listOf(names) + ", but no " +
                           listOf(missing) + ": set data_set/motors to names that are there");
}

std::optional<TimedTorque> TorqueReader::read(const BagMessage& message) {
  const BagConnection& connection = message.connection;
  if (!motors_.empty() && connection.type.rfind("std_msgs/", 0) == 0) {
    throw std::runtime_error("topic " + connection.topic + " has type " + connection.type +
                             ", whose numbers have no names: leave data_set/motors empty");
  }
  TimedTorque out{ros::Time(), message.recorded, ros::Time(), {}};
  if (connection.type == "std_msgs/Float64") {
    out.torque = {parse<std_msgs::Float64>(message).data};
  } else if (connection.type == "std_msgs/Float64MultiArray") {
    out.torque = parse<std_msgs::Float64MultiArray>(message).data;
  } else if (connection.type == "std_msgs/Float32") {
    out.torque = {parse<std_msgs::Float32>(message).data};
  } else if (connection.type == "std_msgs/Float32MultiArray") {
    const std::vector<float> data = parse<std_msgs::Float32MultiArray>(message).data;
    out.torque.assign(data.begin(), data.end());
  } else if (connection.type == "geometry_msgs/WrenchStamped") {
    const auto wrench = parse<geometry_msgs::WrenchStamped>(message);
    const geometry_msgs::Vector3 &f = wrench.wrench.force, &t = wrench.wrench.torque;
    out.stamp = wrench.header.stamp;
    const std::vector<std::string> names = {"force.x",  "force.y",  "force.z",
                                            "torque.x", "torque.y", "torque.z"};
    out.torque = byName(names, {f.x, f.y, f.z, t.x, t.y, t.z}, connection.topic);
    if (out.torque.empty()) {
      throw std::runtime_error("topic " + connection.topic + " has forces and torques along " +
                               listOf(names) + ": set data_set/motors to those of the motors");
    }
  } else if (connection.type == "sensor_msgs/JointState") {
    const auto joints = parse<sensor_msgs::JointState>(message);
    out.stamp = joints.header.stamp;
    if (!motors_.empty() && !anyIn(joints.name, motors_)) return std::nullopt;
    if (joints.effort.empty()) {  // as the message says that they are not known
      ++without_effort_[connection.publisher];
      return std::nullopt;
    }
    if (names_.empty()) names_ = joints.name;
    if (motors_.empty() && joints.name != names_) {
      throw std::runtime_error("the joints of topic " + connection.topic + " change from " +
                               listOf(names_) + " to " + listOf(joints.name) +
                               ": set data_set/motors to those of the motors");
    }
    if (joints.effort.size() != joints.name.size()) {
      throw std::runtime_error("topic " + connection.topic + " has " +
                               std::to_string(joints.effort.size()) + " effort(s) for " +
                               std::to_string(joints.name.size()) +
                               " joint(s): record what commands the motors");
    }
    out.torque =
        motors_.empty() ? joints.effort : byName(joints.name, joints.effort, connection.topic);
    if (std::all_of(out.torque.begin(), out.torque.end(),
                    [](double effort) { return std::isnan(effort); })) {
      ++without_effort_[connection.publisher];
      return std::nullopt;
    }
  } else {
    const auto torque = parse<ddm_msgs::Torque>(message);
    out.stamp = torque.header.stamp;  // that of the image, even if it is 0
    out.torque = torque.torque;       // empty: applied_torque says so where none acted in time
  }
  if (out.torque.empty()) {
    if (connection.type != "ddm_msgs/Torque") ++without_effort_[connection.publisher];
    return std::nullopt;
  }
  const std::string time =
      std::to_string((out.stamp.isZero() ? out.recorded : out.stamp).toSec()) + " s";
  for (const double value : out.torque) {
    if (std::isfinite(value)) continue;
    throw std::runtime_error("the torque at " + time + " must be finite, got " +
                             std::to_string(value) +
                             ": leave this bag out, or mend what commands the motor");
  }
  if (dim_ == 0) dim_ = out.torque.size();
  if (out.torque.size() != dim_) {
    throw std::runtime_error("the torque of topic " + connection.topic + " at " + time + " has " +
                             std::to_string(out.torque.size()) + " value(s) where " +
                             std::to_string(dim_) +
                             " are due: give each robot a topic, or leave this bag out");
  }
  return out;
}

}  // namespace ddm
