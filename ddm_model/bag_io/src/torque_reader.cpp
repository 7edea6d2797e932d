// Reads torques from the messages of a bag, which may have several types.
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
#include <functional>

#include "bag_texts.h"

namespace ddm {
namespace {

using Names = std::vector<std::string>;

constexpr char kJoints[] = "sensor_msgs/JointState";
constexpr char kWrench[] = "geometry_msgs/WrenchStamped";

/// Content of a torque message of any type.
struct Values {
  ros::Time stamp;             ///< header stamp; 0: there is none
  Names names;                 ///< name of each value; empty: they have no names
  std::vector<double> values;  ///< [N m]
};

/// Reads the values of a message.
using Reader = std::function<Values(const BagMessage&)>;

/// @param take  takes the values from a parsed message
template <class Message, class Take>
Reader readerOf(const Take& take) {
  return [take](const BagMessage& message) { return take(parse<Message>(message)); };
}

const auto kNumber = [](const auto& message) {
  return Values{{}, {}, {static_cast<double>(message.data)}};
};
const auto kArray = [](const auto& message) {
  return Values{{}, {}, std::vector<double>(message.data.begin(), message.data.end())};
};

/// Readers of messages, by type.
const std::map<std::string, Reader> kReaders = {
    {"ddm_msgs/Torque", readerOf<ddm_msgs::Torque>([](const auto& torque) {
       return Values{torque.header.stamp, {}, torque.torque};
     })},
    {"std_msgs/Float64", readerOf<std_msgs::Float64>(kNumber)},
    {"std_msgs/Float64MultiArray", readerOf<std_msgs::Float64MultiArray>(kArray)},
    {"std_msgs/Float32", readerOf<std_msgs::Float32>(kNumber)},
    {"std_msgs/Float32MultiArray", readerOf<std_msgs::Float32MultiArray>(kArray)},
    {kWrench, readerOf<geometry_msgs::WrenchStamped>([](const auto& message) {
       const geometry_msgs::Vector3 &f = message.wrench.force, &t = message.wrench.torque;
       return Values{message.header.stamp,
                     {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"},
                     {f.x, f.y, f.z, t.x, t.y, t.z}};
     })},
    {kJoints, readerOf<sensor_msgs::JointState>([](const auto& joints) {
       return Values{joints.header.stamp, joints.name, joints.effort};
     })}};

std::string listOf(const Names& names) {
  return names.empty() ? "nothing" : boost::algorithm::join(names, ", ");
}

bool anyIn(const Names& names, const Names& wanted) {
  return std::find_first_of(names.begin(), names.end(), wanted.begin(), wanted.end()) !=
         names.end();
}

/// @return values of the motors, in the order of the motors
std::vector<double> valuesOf(const Names& motors, const Values& all, const std::string& topic) {
  std::vector<double> values;
  Names missing;
  for (const std::string& motor : motors) {
    const auto name = std::find(all.names.begin(), all.names.end(), motor);
    if (name == all.names.end()) {
      missing.push_back(motor);
    } else {
      values.push_back(all.values[static_cast<std::size_t>(name - all.names.begin())]);
    }
  }
  if (missing.empty()) return values;
  refuseBag("topic ", topic, " has ", listOf(all.names), ", but no ", listOf(missing),
            ": set data_set/motors to names that are there");
}

}  // namespace

std::vector<std::string> torqueTypes() {
  Names types;
  for (const auto& reader : kReaders) types.push_back(reader.first);
  return types;
}

bool answersImages(const std::string& type) { return type == "ddm_msgs/Torque"; }

std::optional<BagTorque> TorqueReader::read(const BagMessage& message) {
  const auto& [topic, type, md5sum, publisher] = message.connection;
  const Values all = kReaders.at(type)(message);
  if (!motors_.empty() && type.rfind("std_msgs/", 0) == 0) {
    refuseBag("topic ", topic, " has type ", type,
              ", whose numbers have no names: leave data_set/motors empty");
  }
  if (type == kWrench && !anyIn(all.names, motors_)) {
    refuseBag("topic ", topic, " has forces and torques along ", listOf(all.names),
              ": set data_set/motors to those of the motors");
  }
  BagTorque out{all.stamp, message.recorded, all.values};
  if (type == kJoints) {
    if (!motors_.empty() && !anyIn(all.names, motors_)) return std::nullopt;
    if (names_.empty() && !all.values.empty()) names_ = all.names;
    if (motors_.empty() && !all.values.empty() && all.names != names_) {
      refuseBag("the joints of topic ", topic, " change from ", listOf(names_), " to ",
                listOf(all.names), ": set data_set/motors to those of the motors");
    }
    if (!all.values.empty() && all.values.size() != all.names.size()) {
      refuseBag("topic ", topic, " has ", all.values.size(), " effort(s) for ", all.names.size(),
                " joint(s): record what commands the motors");
    }
  }
  const bool by_name = !motors_.empty() && !all.names.empty() && !all.values.empty();
  if (by_name) out.torque = valuesOf(motors_, all, topic);
  // Drivers omit an unknown effort in a JointState, or set it to NaN. applied_torque has no number
  // if no single torque acted.
  const bool is_unknown = std::all_of(out.torque.begin(), out.torque.end(),
                                      [](double value) { return std::isnan(value); });
  if (out.torque.empty() || (type == kJoints && is_unknown)) {
    if (!answersImages(type)) ++without_effort_[publisher];
    return std::nullopt;
  }
  const std::string time = timeText(out.stamp.isZero() ? out.recorded : out.stamp);
  for (const double value : out.torque) {
    if (std::isfinite(value)) continue;
    refuseBag("the torque at ", time, " must be finite, got ", value,
              ": leave this bag out, or mend what commands the motor");
  }
  if (dim_ == 0) dim_ = out.torque.size();
  if (out.torque.size() != dim_) {
    refuseBag("the torque of topic ", topic, " at ", time, " has ", out.torque.size(),
              " value(s) where ", dim_, " are due: give each robot a topic, or leave this bag out");
  }
  return out;
}

std::string TorqueReader::withoutEffort() const {
  Names texts;
  for (const auto& entry : without_effort_) {
    texts.push_back(textOf(entry.second, " messages of ",
                           entry.first.empty() ? "an unnamed node" : entry.first));
  }
  return boost::algorithm::join(texts, " and ");
}

}  // namespace ddm
