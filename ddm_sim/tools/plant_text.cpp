// The plant file that new_plant writes.
// SPDX-License-Identifier: BSD-3-Clause
#include "plant_text.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cstdio>
#include <filesystem>
#include <sstream>

namespace ddm {

namespace fs = std::filesystem;

using boost::algorithm::join;
using Texts = std::vector<std::string>;

std::string pictureFile(const std::string& plant_file) {
  return fs::path(plant_file).replace_extension(".png").string();
}

std::string number(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string list(const std::vector<double>& values) {
  Texts texts;
  for (const double value : values) texts.push_back(number(value));
  return "[" + join(texts, ", ") + "]";
}

std::string unitOf(const ModelJoint& joint) {
  return joint.kind == JointKind::kAngle ? "rad" : "m";
}

std::string rangeOf(const ModelJoint& joint) {
  if (!joint.limited) return "no limits";
  return number(joint.lower, "%.4g") + " to " + number(joint.upper, "%.4g") + " " + unitOf(joint);
}

namespace {

/// Motors as the joints that they move, with units of their torques.
Texts motorNames(const PlantProposal& proposal, const MotorChoice& choice) {
  Texts out;
  for (const std::string& name : choice.joints) {
    for (const ModelJoint& joint : proposal.joints) {
      if (joint.name != name) continue;
      out.push_back(name + (joint.kind == JointKind::kAngle ? " [N m]" : " [N]"));
    }
  }
  return out;
}

/// Relative where the model lies with the plant file or below, so that their folder can be moved.
std::string modelPath(const std::string& named, const std::string& plant_file) {
  if (named.rfind("package://", 0) == 0) return named;
  const fs::path model = fs::absolute(named).lexically_normal();
  const fs::path folder = fs::absolute(plant_file).lexically_normal().parent_path();
  const std::string near = model.lexically_relative(folder).string();
  return near.empty() || near.rfind("..", 0) == 0 ? model.string() : near;
}

std::string quoted(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

std::string quoted(const Texts& texts) {
  Texts all;
  for (const std::string& one : texts) all.push_back(quoted(one));
  return "[" + join(all, ", ") + "]";
}

/// A comment, broken into lines.
std::string comment(const std::string& text, const std::string& indent = "  ") {
  constexpr std::size_t kColumns = 100;
  std::istringstream words(text);
  std::string out, line = indent + "#";
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kColumns) {
      out += line + "\n";
      line = indent + "#";
    }
    line += " " + word;
  }
  return out + line + "\n";
}

}  // namespace

std::string plantText(const std::string& model, const std::string& plant_file,
                      const PlantProposal& proposal, const MotorChoice& choice) {
  const MujocoOptions& options = proposal.options;
  const auto why = [&proposal](const char* key) {
    const auto found = proposal.reasons.find(key);
    return found == proposal.reasons.end() ? std::string() : found->second;
  };
  const auto set = [&proposal](const char* key) {
    const Texts& keys = proposal.to_set;
    return std::string(std::count(keys.begin(), keys.end(), key) > 0 ? "SET: " : "");
  };
  Texts joints, wide;
  for (const ModelJoint& joint : proposal.joints) {
    joints.push_back(joint.name + " [" + unitOf(joint) + "], " + rangeOf(joint));
    if (joint.shownInPart() || (!joint.limited && joint.kind == JointKind::kLength)) {
      wide.push_back(joint.name + " from " + number(joint.shown_lower, "%.3g") + " to " +
                     number(joint.shown_upper, "%.3g") + " m");
    }
  }
  std::ostringstream out;
  out << comment("A plant of " + fs::path(model).filename().string() +
                     ", proposed by new_plant. It works as it is; lines with SET are values that "
                     "the model file does not say. Pictures: " +
                     fs::path(pictureFile(plant_file)).filename().string() +
                     ". All keys: config/mujoco_pendulum.yaml of ddm_sim.",
                 "")
      << "#\n"
      << comment("Joints, in the order of start and goal: " + join(joints, "; ") + ".", "")
      << "\nplant:\n  type: mujoco\n"
      << comment("A relative path starts at the folder of this file.")
      << "  model: " << quoted(modelPath(model, plant_file)) << "\n\n"
      << comment("Motors: " + join(motorNames(proposal, choice), ", ") + "; " + why("motors") + ".")
      << "  motors: " << quoted(options.motors) << "\n"
      << comment(set("max_torque") + "The largest torque of each motor. " + why("max_torque") + ".")
      << "  max_torque: " << list(options.max_torque) << "\n\n"
      << comment("Seconds between two images; " + why("dt") + ".")
      << "  dt: " << number(options.dt, "%.12g") << "\n"
      << (options.timestep > 0.0 ? comment("Time step of the physics; " + why("timestep") + ".") +
                                       "  timestep: " + number(options.timestep, "%.12g") + "\n"
                                 : "")
      << "\n"
      << comment("Each episode starts near this pose: " + why("start") +
                 ". start_std: standard deviation of each position and rate.")
      << "  start: " << list(options.start) << "\n  start_std: " << list(options.start_std)
      << "\n\n"
      << comment("SET: The pose to reach, which the learner is shown as an image. " + why("goal") +
                 ".")
      << "  goal: " << list(options.goal) << "\n"
      << comment(std::string("SET: The goal is reached within this error of each joint ") +
                 (proposal.joints.front().kind == JointKind::kLength && options.error_joints.empty()
                      ? "[m]"
                      : "[deg]") +
                 ".")
      << "  tolerance: " << number(options.tolerance) << "\n";
  if (!options.error_joints.empty()) {
    out << comment("Joints whose error counts; " + why("error_joints") + ".")
        << "  error_joints: " << quoted(options.error_joints) << "\n";
  }
  out << "\n"
      << comment("The camera sees all poses" +
                 (wide.empty()
                      ? std::string(".")
                      : " of " + join(wide, ", ") + "; farther away the robot leaves the image.") +
                 " An MJCF file's own camera: `camera: NAME` instead of these three lines.")
      << "  camera_position: " << list(options.look.position)
      << "\n  camera_look_at: " << list(options.look.look_at)
      << "\n  camera_field_of_view: " << number(options.look.field_of_view)
      << "\n  supersampling: " << options.look.supersampling << "\n";
  if (proposal.feature_dim > 2) {
    out << "\n"
        << comment("Two features for a joint that turns far, one for another one.", "")
        << "model:\n  feature_dim: " << proposal.feature_dim << "\n";
  }
  return out.str();
}

}  // namespace ddm
