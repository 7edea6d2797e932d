// Text of a proposed plant file.
// SPDX-License-Identifier: BSD-3-Clause
#include "plant_text.h"

#include <ddm_common/option_checks.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace ddm {
namespace {

namespace fs = std::filesystem;

using boost::algorithm::join;
using Texts = std::vector<std::string>;

/// A relative path if the model lies in the folder of the plant file or below it, so that the
/// folder can be moved. Otherwise an absolute path.
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

/// Makes a YAML comment, with line breaks.
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

std::string contactSheetOf(const std::string& plant_file) {
  return fs::path(plant_file).replace_extension(".png").string();
}

std::string number(double value, int digits) { return textOf(std::setprecision(digits), value); }

std::string list(const std::vector<double>& values) {
  Texts texts;
  for (const double value : values) texts.push_back(number(value));
  return "[" + join(texts, ", ") + "]";
}

std::string rangeOf(const ModelJoint& joint) {
  const std::string range = number(joint.lower, 4) + " to " + number(joint.upper, 4);
  if (joint.limited) return range + (joint.isHinge() ? " rad" : " m");
  return joint.isHinge() ? "no limits" : "no limits, in the image from " + range + " m";
}

std::string plantText(const std::string& model, const std::string& plant_file,
                      const PlantProposal& proposal) {
  const MujocoOptions& options = proposal.options;
  Texts joints;
  for (const ModelJoint& joint : proposal.joints) {
    joints.push_back(joint.name + (joint.isHinge() ? " [rad], " : " [m], ") + rangeOf(joint));
  }
  std::ostringstream out;
  // Writes a key, and above it a comment with the meaning of the key and the reason for its value.
  const auto write = [&](const char* key, const std::string& value, const std::string& meaning) {
    const auto why = proposal.reasons.find(key);
    const bool set = proposal.to_set.count(key) > 0;
    out << comment((set ? "SET: " : "") + meaning +
                   (why == proposal.reasons.end() ? "" : " (" + why->second + ")") + ".")
        << "  " << key << ": " << value << "\n";
  };
  out << comment("A plant of " + fs::path(model).filename().string() +
                     ", proposed by new_plant. It works as it is; lines with SET are values that "
                     "the model file does not say. Images: " +
                     fs::path(contactSheetOf(plant_file)).filename().string() +
                     ". All keys: config/mujoco_pendulum.yaml of ddm_sim.",
                 "")
      << "#\n"
      << comment("Joints, in the order of start and goal: " + join(joints, "; ") + ".", "")
      << "\nplant:\n  type: mujoco\n";
  write("model", quoted(modelPath(model, plant_file)),
        "A relative path starts at the folder of this file");
  write("motors", quoted(options.motors), "Motors: " + join(proposal.motors, ", "));
  write("max_torque", list(options.max_torque), "The largest torque of each motor [N m, slides N]");
  write("dt", number(options.dt, 12), "Seconds between two images");
  if (options.timestep > 0.0) {
    write("timestep", number(options.timestep, 12), "Time step of the physics [s]");
  }
  write("start", list(options.start), "Each episode starts near this pose");
  write("start_std", list(options.start_std),
        "Standard deviation of each position and rate of the initial state");
  write("goal", list(options.goal), "The pose to reach, which the learner is shown as an image");
  const bool has_hinges = std::any_of(proposal.joints.begin(), proposal.joints.end(),
                                      [](const ModelJoint& joint) { return joint.isHinge(); });
  write("tolerance", number(options.tolerance),
        std::string("The goal is reached within this error of each ") +
            (has_hinges ? "hinge [deg]" : "joint [m]"));
  write("camera_position", list(options.look.position),
        "The camera sees all poses. For a camera of an MJCF file, write `camera: NAME` instead of "
        "these two keys");
  write("camera_look_at", list(options.look.look_at), "The point in the middle of the image");
  write("supersampling", std::to_string(options.look.supersampling),
        "Images are drawn so many times larger, then averaged, so that edges are soft");
  return out.str();
}

}  // namespace ddm
