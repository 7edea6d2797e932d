// URDF: what MuJoCo has to be told to take it as its author meant it.
// SPDX-License-Identifier: BSD-3-Clause
#include "urdf.h"

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr char kScheme[] = "package://";

/// MuJoCo by default drops visual shapes and the folders of meshes, takes the mass of a link from
/// its shapes where it has no <inertial>, and refuses inertias that rounding has made impossible.
constexpr char kCompiler[] =
    "<mujoco><compiler discardvisual=\"false\" strippath=\"false\" inertiafromgeom=\"false\" "
    "balanceinertia=\"true\"/></mujoco>";

bool has(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

}  // namespace

bool isUrdf(const std::string& text) { return has(text, "<robot") && has(text, "</robot>"); }

bool hasMujocoBlock(const std::string& text) { return has(text, "<mujoco"); }

std::string urdfForMujoco(const std::string& text) {
  if (hasMujocoBlock(text)) return text;
  std::string out = text;
  return out.insert(out.rfind("</robot>"), kCompiler);
}

std::string hintFor(const std::string& text, const std::string& error) {
  if (has(text, "<xacro:") || has(text, "${")) {
    return "this is xacro: make URDF of it, xacro FILE > robot.urdf";
  }
  if (has(error, "mesh file type")) {
    return "MuJoCo reads STL, OBJ and MSH: convert the mesh, or leave this shape out";
  }
  if (has(error, "mass and inertia of moving bodies") && isUrdf(text)) {
    return "each link that a joint moves must have an <inertial>";
  }
  return "";
}

std::map<std::string, double> effortLimits(const std::string& text) {
  namespace pt = boost::property_tree;
  std::istringstream in(text);
  pt::ptree root;
  try {
    pt::read_xml(in, root);
  } catch (const pt::xml_parser_error& e) {
    throw std::invalid_argument("line " + std::to_string(e.line()) + ": " + e.message());
  }
  std::map<std::string, double> limits;
  const auto robot = root.get_child_optional("robot");
  if (!robot) return limits;
  for (const auto& child : *robot) {
    if (child.first != "joint") continue;
    const auto effort = child.second.get_optional<double>("limit.<xmlattr>.effort");
    if (effort) limits[child.second.get("<xmlattr>.name", "")] = *effort;
  }
  return limits;
}

std::string withoutPackageUris(std::string text, const FindPackage& find_package) {
  for (std::size_t at = 0; (at = text.find(kScheme, at)) != std::string::npos;) {
    const std::size_t name = at + sizeof(kScheme) - 1;
    const std::size_t end = text.find_first_of("/\"'<> \n", name);
    const std::string package = text.substr(name, end - name);
    const std::string folder = find_package(package);
    if (folder.empty()) {
      throw std::invalid_argument("package " + package +
                                  " cannot be found: source the setup.bash of its workspace");
    }
    text.replace(at, end - at, folder);
    at += folder.size();
  }
  return text;
}

}  // namespace ddm
