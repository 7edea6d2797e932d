// Fuzz targets of ddm_sim: the inputs of robot_node, and the standard input of simulate.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>
#include <ddm_robot/stamp_check.h>
#include <ddm_robot/torque_gate.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "../tools/number_csv.h"

using ddm::TorqueGate;
using ddm::testing::FuzzBytes;
using ddm::testing::require;

namespace {

ddm::Stamp drawStamp(FuzzBytes* bytes) {
  const auto seconds = std::chrono::seconds(bytes->number<std::uint32_t>());
  return seconds + ddm::Stamp(bytes->number<std::uint32_t>());
}

void act(std::uint8_t kind, ddm::SteadyTime time, ddm::Stamp stamp, FuzzBytes* bytes,
         TorqueGate* gate) {
  switch (kind % 10) {
    case 0:
      gate->arm(time);
      break;
    case 1:
      gate->stop("service enable stopped them");
      break;
    case 2:
      gate->beginReset();
      break;
    case 3:
      gate->endReset();
      break;
    case 4:
      gate->endTrial();
      break;
    case 5:
      gate->showImage(time, stamp);
      break;
    case 6:
      gate->setPublishers(bytes->number<std::uint8_t>() % 3);
      break;
    case 7:
      gate->setListeners(bytes->number<std::uint8_t>() % 2);
      break;
    case 8: {
      std::vector<double> values(bytes->number<std::uint8_t>() % 4);
      for (double& value : values) value = bytes->number<double>();
      ddm::JointReport report;
      report.arrival = time;
      report.clock = report.stamp = stamp;
      report.reporter = "/driver";
      report.names.assign(values.size(), "joint");
      report.positions = report.velocities = values;
      gate->takeJoints(report);
      break;
    }
    default: {
      std::vector<double> torque(bytes->number<std::uint8_t>() % 4);
      for (double& value : torque) value = bytes->number<double>();
      const bool acts = gate->takeTorque(time, stamp, torque);
      const bool fits = torque.size() == gate->target().size() &&
                        std::all_of(torque.begin(), torque.end(),
                                    [](double value) { return std::isfinite(value); });
      require(!acts || fits, "torques are checked");
    }
  }
}

/// Inputs of robot_node in any order and at any time: images, torques, service calls. Fuzz input:
/// for each event its kind (1 byte), the time since the previous event (4 bytes), the stamp of an
/// image (8 bytes), data of this kind, then the clock of this machine (8 bytes).
void robotInput(const std::uint8_t* data, std::size_t size) {
  FuzzBytes bytes(data, size);
  ddm::RobotOptions options;
  options.slew_rate = {static_cast<double>(bytes.number<std::uint8_t>())};
  const auto kind_of_robot = bytes.number<std::uint8_t>();
  if (kind_of_robot % 2 == 1) options.position_limits = {{-1.0, 1.0}};
  if (kind_of_robot / 2 % 2 == 1) options.max_torque = {4.0, 2.0};
  TorqueGate gate(options);
  ddm::StampCheck stamps(options.dt);
  ddm::ImagePicker picker(options.dt);
  ddm::SteadyTime time{};
  while (!bytes.empty()) {
    const auto kind = bytes.number<std::uint8_t>();
    time += std::chrono::nanoseconds(bytes.number<std::uint32_t>());
    const ddm::Stamp stamp = drawStamp(&bytes);
    act(kind, time, stamp, &bytes, &gate);
    const std::vector<double>& effort = gate.effort(time);
    require(effort.size() == options.max_torque.size(), "each motor has a torque");
    for (std::size_t i = 0; i < effort.size(); ++i) {
      require(std::abs(effort[i]) <= options.max_torque[i], "the bound of each motor holds");
      require(effort[i] == 0.0 || gate.state() == TorqueGate::State::kFollowing,
              "no torque but in a trial");
    }
    if (stamps.take(time, drawStamp(&bytes), stamp).empty()) {
      require(stamps.taken() <= time, "no image is taken after its arrival");
      picker.pick(stamp);
    }
    require(std::isfinite(picker.step()) && picker.step() >= 0.0, "a step is a time");
  }
  require(!gate.describe().empty(), "a state has words");
}

/// Numbers on the standard input of simulate.
void simulateTorques(const std::uint8_t* data, std::size_t size) {
  std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
  std::vector<Eigen::VectorXd> torques;
  const auto read = [&] { torques = ddm::readNumbers(text, {"dx_px", "dy_px"}, "a torque"); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return;
  for (const Eigen::VectorXd& torque : torques) {
    ddm::testing::require(torque.size() == 2 && torque.allFinite(), "torques are finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::FuzzTarget target = ddm::testing::chosenTarget(
      {{"robot_input", robotInput}, {"simulate_torques", simulateTorques}});
  target(data, size);
  return 0;
}
