// new_plant: proposes a plant file for a model file, and draws a contact sheet of its images.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_codec.h>
#include <ddm_common/plain_file.h>
#include <ddm_mujoco/plant_proposal.h>
#include <ddm_plant_plugin/image_message.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/split.hpp>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_common/option_checks.h"
#include "ddm_common/param_reader.h"
#include "ddm_common/param_value.h"
#include "ddm_common/tool.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

using boost::algorithm::join;
using Texts = std::vector<std::string>;

constexpr char kAbout[] =
    "Makes a plant of a robot's model file: proposes motors, torques, time step, start, goal and\n"
    "camera, simulates it, and writes a plant file that simulate, run_experiment and the launch\n"
    "files accept as it is. The values that it cannot know are marked SET in that file.\n\n"
    "usage: rosrun ddm_sim new_plant ROBOT.urdf|ROBOT.xml --out my_plant.yaml [options]\n\n"
    "Also writes my_plant.png beside it: the start, the goal and random poses, large and as the\n"
    "learner sees them.\n"
    "Exit:   0 done, 1 the model cannot be a plant as it is, 2 bad options.\n\n"
    "Options";

struct Arguments {
  std::string model;
  std::string out;
  Texts motors;
  std::vector<double> max_torque;
  bool force = false;
};

/// Name of the contact sheet (PNG) beside a plant file.
std::string contactSheetOf(const std::string& plant_file) {
  return fs::path(plant_file).replace_extension(".png").string();
}

Texts partsOf(const std::string& text) {
  Texts parts;
  boost::algorithm::split(parts, text, [](char c) { return c == ','; });
  return parts;
}

/// @throws po::error naming an output file that exists and must not be replaced
void requireRoom(const Arguments& arguments) {
  const fs::path folder = fs::absolute(arguments.out).parent_path();
  if (!fs::is_directory(folder)) {
    throw po::error("option --out must be in a folder that exists, got " + folder.string() +
                    ": make it first");
  }
  for (const std::string& file : {arguments.out, contactSheetOf(arguments.out)}) {
    if (arguments.force || !fs::exists(file)) continue;
    throw po::error(file + " is there already: choose another name, or replace it by --force");
  }
}

/// @return false if the only option is --help, whose text has been printed
/// @throws po::error if the arguments are wrong
bool parse(int argc, char** argv, Arguments* arguments) {
  std::string motors, max_torque;
  po::options_description options(kAbout);
  auto add = options.add_options();
  add("out", po::value(&arguments->out)->required()->value_name("FILE.yaml"),
      "plant file to write");
  add("motors", po::value(&motors)->value_name("A,B"),
      "joints that have a motor; without it the file's actuators, or for a URDF the joints with an "
      "effort limit if one or two joints have one");
  add("max-torque", po::value(&max_torque)->value_name("V1,V2"),
      "limit of each motor, in their order [N m, slides N]; without it the file's limits, or "
      "estimates from weight and inertia");
  add("force", po::bool_switch(&arguments->force), "replace files that are there");
  if (!parseCommandLine(argc, argv, options,
                        Positional{"model", po::value(&arguments->model), 1})) {
    return false;
  }
  if (arguments->model.empty()) throw po::error("the model file is missing: a URDF or MJCF file");
  if (!motors.empty()) arguments->motors = partsOf(motors);
  for (const std::string& part : max_torque.empty() ? Texts() : partsOf(max_torque)) {
    double value = 0.0;
    if (!parseNumber(part, &value) || value <= 0.0) {
      throw po::error("option --max-torque must be numbers > 0, one for each motor, got \"" +
                      max_torque + "\"");
    }
    arguments->max_torque.push_back(value);
  }
  if (!namesPlantFile(arguments->out)) {
    throw po::error("option --out must name a file that ends in .yaml, got \"" + arguments->out +
                    "\"");
  }
  requireRoom(*arguments);
  return true;
}

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

/// At most so many significant digits.
std::string number(double value, int digits = 7) {
  return textOf(std::setprecision(digits), value);
}

/// Numbers as a YAML list.
std::string list(const std::vector<double>& values) {
  Texts texts;
  for (const double value : values) texts.push_back(number(value));
  return "[" + join(texts, ", ") + "]";
}

/// Range of a joint: "-1 to 1 rad", or "no limits".
std::string rangeOf(const ModelJoint& joint) {
  const std::string range = number(joint.lower, 4) + " to " + number(joint.upper, 4);
  if (joint.limited) return range + (joint.isHinge() ? " rad" : " m");
  return joint.isHinge() ? "no limits" : "no limits, in the image from " + range + " m";
}

/// Kind, range and effort limit of a joint.
std::string describe(const ModelJoint& joint) {
  const std::string effort = joint.effort > 0.0 ? "effort limit " + number(joint.effort, 4) +
                                                      (joint.isHinge() ? " N m" : " N")
                                                : "no effort limit";
  return joint.name + (joint.isHinge() ? " [rad]: hinge, " : " [m]: slide, ") + rangeOf(joint) +
         ", " + effort;
}

/// Content of the plant file, with the reason for each value as a comment.
std::string plantText(const std::string& model, const std::string& plant_file,
                      const PlantProposal& proposal) {
  const MujocoOptions& options = proposal.options;
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
      << "#\n# Joints, in the order of start and goal:\n";
  for (const ModelJoint& joint : proposal.joints) out << comment(describe(joint), "");
  out << "\nplant:\n  type: mujoco\n";
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

constexpr int kCell = 204;  // size of an image, four times the learner's [pixels]
constexpr int kColumns = 6;
constexpr int kLine = 22;  // height of a line of text [pixels]

cv::Mat colourOf(RenderedImage rendered) {
  cv::Mat out(rendered.height, rendered.width, rendered.channels == 1 ? CV_8UC1 : CV_8UC3,
              rendered.bytes.data());
  if (rendered.channels == 1) cv::cvtColor(out, out, cv::COLOR_GRAY2RGB);
  return out.clone();
}

/// Draws several poses in rows: a large image of each pose, and the learner's image below.
void writeContactSheet(const PlantProposal& proposal, const Plant& plant, const std::string& file) {
  std::vector<std::pair<std::string, Eigen::VectorXd>> poses = {{"start", plant.info().start},
                                                                {"goal", plant.info().goal}};
  for (std::size_t i = 0; poses.size() < 2 * kColumns; ++i) {
    poses.emplace_back("pose " + std::to_string(i + 1), proposal.poses.at(i));
  }
  const int rows = static_cast<int>(poses.size()) / kColumns;
  cv::Mat sheet((2 * kCell + kLine + 4) * rows, (kCell + 4) * kColumns, CV_8UC3,
                cv::Scalar::all(255));
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    const auto& [name, state] = poses[static_cast<std::size_t>(i)];
    const int x = (kCell + 4) * (i % kColumns), y = (2 * kCell + kLine + 4) * (i / kColumns);
    cv::putText(sheet, name, {x + 4, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(0), 1,
                cv::LINE_AA);
    const cv::Mat view = colourOf(plant.view(state));
    const int side = std::min(view.rows, view.cols);
    const cv::Rect middle((view.cols - side) / 2, (view.rows - side) / 2, side, side);
    cv::resize(view(middle), sheet(cv::Rect(x, y + kLine, kCell, kCell)), {kCell, kCell}, 0, 0,
               cv::INTER_AREA);
    cv::resize(colourOf(plant.render(state)), sheet(cv::Rect(x, y + kLine + kCell, kCell, kCell)),
               {kCell, kCell}, 0, 0, cv::INTER_NEAREST);
  }
  const RenderedImage rendered{
      sheet.cols, sheet.rows, 3, {sheet.data, sheet.data + sheet.total() * sheet.elemSize()}, {}};
  writeImageFile(file, imageMessage(rendered, ros::Time()));
}

void printCheck(const mjModel& model, const PlantProposal& proposal, const PlantCheck& check) {
  std::cout << "simulation: stable under random torques\nimage: " << check.changed_pixels
            << " of 2601 pixels differ between two poses\n";
  constexpr int kFewPixels = 25;
  const auto warn = [](const std::string& text) { std::cout << "warning: " << text << "\n"; };
  if (!check.unseen.empty()) {
    warn("the image does not change with " + join(check.unseen, ", ") +
         ": a learner cannot see this joint; give its link a shape that is not symmetric about the "
         "axis, or another camera_position");
  }
  if (check.changed_pixels < kFewPixels) {
    warn(
        "the robot is small or thin in the image: a learner sees little of it; thicken its "
        "shapes, brighten them, narrow the joints' limits, or bring the camera nearer");
  }
  if (std::any_of(model.eq_type, model.eq_type + model.neq,
                  [](int type) { return type == mjEQ_CONNECT || type == mjEQ_WELD; })) {
    warn(
        "the file ties bodies by <connect> or <weld>, which the proposed start and goal ignore: "
        "write positions that keep these ties into plant/start and plant/goal");
  }
  constexpr double kNarrow = 0.1;  // a usual range in radians that MuJoCo has read as degrees [rad]
  for (const ModelJoint& joint : proposal.joints) {
    if (joint.isHinge() && joint.upper - joint.lower < kNarrow) {
      warn("the range of " + joint.name + " is only " + rangeOf(joint) +
           ": MJCF has degrees unless the file has <compiler angle=\"radian\"/>");
    }
  }
}

void newPlant(const Arguments& arguments) {
  const auto model = std::make_shared<MujocoModel>(
      arguments.model, [](const std::string& package) { return ros::package::getPath(package); });
  std::cout << arguments.model << ": " << model->get().njnt << " joint(s), " << model->get().nu
            << " actuator(s)\n";
  const PlantProposal proposal = proposePlant(model, arguments.motors, arguments.max_torque);
  const std::string text = plantText(arguments.model, arguments.out, proposal);
  std::cout << text;

  // The draft lies in the folder of the final file, because relative paths count from there. It is
  // removed if a later step fails.
  const std::string draft = arguments.out + ".unfinished";
  const std::shared_ptr<void> cleanup(nullptr, [&draft](void*) {
    std::error_code ignored;
    fs::remove(draft, ignored);
  });
  writeFileAtomically(draft, text);
  const std::unique_ptr<Plant> plant = makePlant(*readPlantFiles({draft}));
  printCheck(model->get(), proposal, checkPlant(proposal, *plant));
  writeContactSheet(proposal, *plant, contactSheetOf(arguments.out));
  renameDurably(draft, arguments.out);

  std::cout << "\nwrote " << arguments.out << " and " << contactSheetOf(arguments.out)
            << "\nset in " << arguments.out << ":";
  for (const std::string& key : proposal.to_set) std::cout << " plant/" << key;
  const std::string name =
      (arguments.out.find('/') == std::string::npos ? "./" : "") + arguments.out;
  std::cout << "\nthen:\n  rosrun ddm_launch run_experiment --preset efficient --plant " << name
            << " --seed 1 --trials 5 --out " << fs::path(arguments.out).stem().string() << "_run\n";
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::Arguments arguments;
  return ddm::runTool(
      "new_plant", [&] { return ddm::parse(argc, argv, &arguments); },
      [&] { ddm::newPlant(arguments); });
}
