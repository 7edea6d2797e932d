// What a plant says of itself, as YAML for people and scripts.
// SPDX-License-Identifier: BSD-3-Clause
#include "plant_description.h"

#include <ddm_params/param_value.h>

#include <vector>

namespace ddm {
namespace {

YAML::Node numbers(const Eigen::VectorXd& values) {
  return valueToYaml(std::vector<double>(values.data(), values.data() + values.size()));
}

}  // namespace

std::string describe(const PlantInfo& info) {
  YAML::Node about;
  for (const Joint& joint : info.joints) {
    YAML::Node entry;
    entry.SetStyle(YAML::EmitterStyle::Flow);
    entry["name"] = joint.name;
    entry["kind"] = joint.kind == JointKind::kAngle ? "angle" : "length";
    about["joints"].push_back(entry);
  }
  about["state"] = valueToYaml(info.state_names);
  about["torque"] = valueToYaml(info.torque_names);
  about["max_torque"] = numbers(info.max_torque);
  about["dt"] = valueToYaml(info.dt);
  about["start"] = numbers(info.start);
  about["start_std"] = numbers(info.start_std);
  about["goal"] = numbers(info.goal);
  about["error_unit"] = info.error_unit;
  about["tolerance"] = valueToYaml(info.tolerance);
  return YAML::Dump(about) + "\n";
}

}  // namespace ddm
