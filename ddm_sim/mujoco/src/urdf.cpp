// Checks a URDF file, and changes what MuJoCo would read in another way than the author meant.
// SPDX-License-Identifier: BSD-3-Clause
#include "urdf.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <filesystem>
#include <locale>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "ddm_sim/angles.h"
#include "model_files.h"
#include "xml_text.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using boost::algorithm::join;
using tinyxml2::XMLElement;

const std::vector<std::string> kJointTypes = {"revolute", "continuous", "prismatic",
                                              "fixed",    "floating",   "planar"};
const std::vector<std::string> kShapes = {"box", "cylinder", "sphere", "mesh"};

bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "<joint hinge> in line 7"
std::string placeOf(const XMLElement& element) {
  const std::string name = attribute(element, "name");
  return std::string("<") + element.Value() + (name.empty() ? "" : " " + name) + "> in line " +
         std::to_string(element.GetLineNum());
}

[[noreturn]] void refuse(const XMLElement& element, const std::string& what) {
  throw std::invalid_argument(placeOf(element) + " " + what);
}

std::vector<XMLElement*> children(const XMLElement& parent, const char* name) {
  std::vector<XMLElement*> out;
  for (auto* child = parent.FirstChildElement(name); child != nullptr;
       child = child->NextSiblingElement(name)) {
    out.push_back(const_cast<XMLElement*>(child));
  }
  return out;
}

/// A number that an element within `parent` may have.
/// @throws std::invalid_argument if it is there and no finite number
std::optional<double> number(const XMLElement& parent, const char* child, const char* name) {
  const XMLElement* const element = parent.FirstChildElement(child);
  const char* const text = element == nullptr ? nullptr : element->Attribute(name);
  if (text == nullptr) return std::nullopt;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0.0;
  if (in >> value && (in >> std::ws).eof() && std::isfinite(value)) return value;
  refuse(parent, std::string("must have a finite number for ") + name + " in <" + child +
                     ">, got \"" + text + "\"");
}

double numberOr(const XMLElement& parent, const char* child, const char* name, double none) {
  return number(parent, child, name).value_or(none);
}

std::string linkOf(const XMLElement& joint, const char* end) {
  const XMLElement* const element = joint.FirstChildElement(end);
  const std::string link = element == nullptr ? "" : attribute(*element, "link");
  if (link.empty()) refuse(joint, std::string("must have <") + end + " link=\"...\"/>");
  return link;
}

void requireNames(const std::vector<XMLElement*>& elements) {
  std::set<std::string> names;
  for (const XMLElement* element : elements) {
    const std::string name = attribute(*element, "name");
    if (name.empty()) refuse(*element, "must have a name");
    if (!names.insert(name).second) refuse(*element, "has the name of another one: rename it");
  }
}

void requireNoXacro(XMLElement* root) {
  forEachElement(root, [](XMLElement* element) {
    std::string found;
    if (std::string(element->Value()).rfind("xacro:", 0) == 0) found = element->Value();
    for (auto* one = element->FirstAttribute(); one != nullptr; one = one->Next()) {
      const std::string value = one->Value();
      if (value.find("${") != std::string::npos || value.find("$(") != std::string::npos) {
        found = value;
      }
    }
    if (found.empty()) return;
    throw std::invalid_argument("line " + std::to_string(element->GetLineNum()) + " has " + found +
                                ", this is xacro: run xacro FILE > robot.urdf, and name that file");
  });
}

void requireKnownType(const XMLElement& joint) {
  const std::string type = attribute(joint, "type");
  if (type == "floating" || type == "planar") {
    refuse(joint,
           "is " + type +
               ", and a plant of a model file has hinges and slides alone: make it fixed, or "
               "put prismatic, continuous or revolute joints in its place");
  }
  if (isOneOf(kJointTypes, type)) return;
  const std::string lower = boost::to_lower_copy(type);
  refuse(joint, "must have one of the types of URDF, which are " + join(kJointTypes, ", ") +
                    ", got " + (type.empty() ? "none" : "\"" + type + "\"") +
                    (isOneOf(kJointTypes, lower) ? ": did you mean " + lower + "?" : ""));
}

/// Joints connect the links to one tree.
void requireTree(const std::vector<XMLElement*>& links, const std::vector<XMLElement*>& joints) {
  std::vector<std::string> names;
  for (const XMLElement* link : links) names.push_back(attribute(*link, "name"));
  std::map<std::string, const XMLElement*> to_parent;
  for (const XMLElement* joint : joints) {
    for (const char* end : {"parent", "child"}) {
      const std::string link = linkOf(*joint, end);
      if (isOneOf(names, link)) continue;
      refuse(*joint, std::string("names the ") + end + " link " + link +
                         ", which is not declared: add <link name=\"" + link + "\"/>, or " +
                         suggestion(link, names));
    }
    const std::string child = linkOf(*joint, "child");
    if (child == "world") {
      refuse(*joint,
             "has the child link world, which MuJoCo takes for the ground: rename the link");
    }
    if (!to_parent.emplace(child, joint).second) {
      refuse(*joint, "has the child link " + child + ", which is already that of the joint " +
                         attribute(*to_parent[child], "name") + ": a link has one parent");
    }
  }
  for (const std::string& name : names) {
    std::set<std::string> seen;
    for (std::string link = name; to_parent.count(link) > 0;) {
      if (!seen.insert(link).second) {
        refuse(*to_parent[link], "closes a cycle of links through " + link +
                                     ": URDF has trees alone; remove one joint of the cycle");
      }
      link = linkOf(*to_parent[link], "parent");
    }
  }
  std::vector<std::string> roots;
  for (const std::string& name : names) {
    if (to_parent.count(name) == 0) roots.push_back(name);
  }
  if (roots.size() == 1) return;
  throw std::invalid_argument("the robot must have one root link, got " +
                              (roots.empty() ? "none" : join(roots, ", ")) +
                              ": connect these links by fixed joints, or remove those of no use");
}

/// Sizes are positive; a mesh that is mirrored has a negative scale.
void requireSizes(const XMLElement& link, const XMLElement& shape) {
  for (const char* name : {"size", "radius", "length", "scale"}) {
    std::istringstream in(attribute(shape, name));
    in.imbue(std::locale::classic());
    for (double number = 0.0; in >> number;) {
      const bool scale = std::string(name) == "scale";
      if (number > 0.0 || (scale && number < 0.0)) continue;
      refuse(shape, "of the link " + attribute(link, "name") + " must have a " + name +
                        (scale ? " without 0" : " > 0") + ", got \"" + attribute(shape, name) +
                        "\": correct it, or leave the shape out");
    }
  }
}

XMLElement* requireShape(const XMLElement& link, const XMLElement& part) {
  const XMLElement* const geometry = part.FirstChildElement("geometry");
  auto* const shape =
      const_cast<XMLElement*>(geometry == nullptr ? nullptr : geometry->FirstChildElement());
  const std::string name = shape == nullptr ? "nothing" : shape->Value();
  if (isOneOf(kShapes, name)) {
    requireSizes(link, *shape);
    return shape;
  }
  refuse(part,
         "of the link " + attribute(link, "name") +
             " must have a <geometry> of box, cylinder, sphere or mesh, got " + name +
             (name == "capsule"
                  ? ": URDF has no capsules; make it a cylinder and two spheres, or write MJCF"
                  : ""));
}

/// A link that a joint moves has mass and inertia, by itself or by the links that are fixed to it.
void requireInertia(const std::string& link, const std::map<std::string, const XMLElement*>& links,
                    const std::map<std::string, std::string>& fixed) {
  const XMLElement& moved = *links.at(link);
  const auto massOf = [](const XMLElement& one) {
    const XMLElement* const inertial = one.FirstChildElement("inertial");
    return inertial == nullptr ? 0.0 : numberOr(*inertial, "mass", "value", 0.0);
  };
  std::string point_mass;
  for (const auto& one : fixed) {
    std::string parent = one.first;
    while (parent != link && fixed.count(parent) > 0) parent = fixed.at(parent);
    const XMLElement& carried = *links.at(one.first);
    if (parent != link || massOf(carried) <= 0.0) continue;
    if (numberOr(*carried.FirstChildElement("inertial"), "inertia", "ixx", 0.0) > 0.0) return;
    point_mass = " (the link " + one.first + ", which is fixed to it, is a point mass)";
  }
  const XMLElement* const inertial = moved.FirstChildElement("inertial");
  if (inertial == nullptr) {
    refuse(moved, "is moved by a joint and has no <inertial>" + point_mass +
                      ": give it a mass and an inertia");
  }
  if (massOf(moved) <= 0.0) {
    refuse(moved, "is moved by a joint and must have a mass > 0 in its <inertial>, got " +
                      std::to_string(massOf(moved)));
  }
  for (const char* axis : {"ixx", "iyy", "izz"}) {
    const double inertia = numberOr(*inertial, "inertia", axis, 0.0);
    if (inertia > 0.0) continue;
    refuse(moved, std::string("is moved by a joint and must have inertias > 0, got ") +
                      (inertia == 0.0 ? "0" : std::to_string(inertia)) + " for " + axis +
                      ": a point mass cannot be simulated; give it the inertia of its shape");
  }
}

/// The file that an attribute names, as a path.
std::string fileOf(const XMLElement& element, const std::string& name, const fs::path& folder,
                   const FindPackage& find_package) {
  try {
    const std::string path = resolved(attribute(element, name.c_str()), find_package);
    return (folder / path).lexically_normal().string();
  } catch (const std::invalid_argument& e) {
    refuse(element, e.what());
  }
}

/// `meshdir` and `strippath` of a <mujoco> block, as MuJoCo applies them: by default it strips the
/// folder.
std::optional<fs::path> inMeshFolder(const XMLElement* compiler, const std::string& name) {
  if (compiler == nullptr || compiler->Attribute("meshdir") == nullptr) return std::nullopt;
  const bool keeps_folders = attribute(*compiler, "strippath") == "false";
  return fs::path(attribute(*compiler, "meshdir")) /
         (keeps_folders ? fs::path(name) : fs::path(name).filename());
}

/// Gives each file of a mesh a name of its own: MuJoCo tells meshes apart by the name without its
/// folder.
class MeshNames {
 public:
  MeshNames(const fs::path& folder, const FindPackage& find_package, const XMLElement* compiler)
      : folder_(folder), find_package_(find_package), compiler_(compiler) {}

  /// Renames the file of a <mesh>.
  void name(XMLElement* mesh) {
    const std::string named = attribute(*mesh, "filename");
    if (named.empty()) refuse(*mesh, "must have a filename");
    const auto in_folder = inMeshFolder(compiler_, named);
    const std::string file = in_folder && fs::is_regular_file(folder_ / *in_folder)
                                 ? (folder_ / *in_folder).string()
                                 : fileOf(*mesh, "filename", folder_, find_package_);
    if (fs::is_directory(file)) refuse(*mesh, "names a folder, " + file + ": name a mesh in it");
    if (!isMeshKind(file)) {
      unreadable_.insert(named);
      return;
    }
    requireMesh(*mesh, named, file);
    std::string& name = names_[{file, attribute(*mesh, "scale")}];
    if (name.empty()) {
      const std::string kind = boost::to_lower_copy(fs::path(file).extension().string());
      name = std::to_string(names_.size()) + "_" + fs::path(file).stem().string() + kind;
      files.emplace_back(name, file);
    }
    mesh->SetAttribute("filename", name.c_str());
  }

  /// @throws std::invalid_argument with all files that MuJoCo does not read
  void requireReadable() const {
    if (unreadable_.empty()) return;
    const fs::path first(*unreadable_.begin());
    throw std::invalid_argument(
        "it has meshes that are no STL, OBJ or MSH files, which MuJoCo reads: " +
        join(unreadable_, ", ") + "; convert each, for example by `assimp export " +
        first.filename().string() + " " + first.stem().string() +
        ".stl` (Debian's assimp-utils), and name the new files in the model");
  }

  std::vector<std::pair<std::string, std::string>> files;  ///< by their new names

 private:
  fs::path folder_;
  const FindPackage& find_package_;
  const XMLElement* compiler_;
  std::map<std::pair<std::string, std::string>, std::string> names_;  // by file and scale
  std::set<std::string> unreadable_;
};

/// MuJoCo by default drops visual shapes, takes the mass of a link from its shapes where it has no
/// <inertial>, and refuses inertias that rounding has made impossible.
void completeCompiler(XMLElement* compiler) {
  const std::pair<const char*, const char*> ours[] = {
      {"discardvisual", "false"}, {"inertiafromgeom", "false"}, {"balanceinertia", "true"}};
  for (const auto& one : ours) {
    if (compiler->Attribute(one.first) == nullptr) compiler->SetAttribute(one.first, one.second);
  }
  compiler->SetAttribute("strippath", "false");  // MeshNames has applied both
  compiler->DeleteAttribute("meshdir");
}

/// Leaves out what MuJoCo does not read, such as <gazebo> and <transmission>.
void keepWhatMujocoReads(XMLElement* robot) {
  for (auto* child = robot->FirstChildElement(); child != nullptr;) {
    auto* const next = child->NextSiblingElement();
    if (!isOneOf({"link", "joint", "material", "mujoco"}, child->Value()))
      robot->DeleteChild(child);
    child = next;
  }
}

XMLElement* firstChild(XMLElement* parent, const char* name) {
  if (auto* const there = parent->FirstChildElement(name)) return there;
  return parent->InsertFirstChild(parent->GetDocument()->NewElement(name))->ToElement();
}

Coupling couplingOf(const XMLElement& joint, const std::vector<XMLElement*>& joints) {
  const XMLElement& mimic = *joint.FirstChildElement("mimic");
  Coupling coupling;
  coupling.follower = attribute(joint, "name");
  coupling.leader = attribute(mimic, "joint");
  coupling.multiplier = numberOr(joint, "mimic", "multiplier", 1.0);
  coupling.offset = numberOr(joint, "mimic", "offset", 0.0);
  std::vector<std::string> moving;
  for (const XMLElement* one : joints) {
    if (attribute(*one, "type") != "fixed") moving.push_back(attribute(*one, "name"));
  }
  if (coupling.leader == coupling.follower || !isOneOf(moving, coupling.leader)) {
    refuse(joint, "must mimic another joint that moves, got \"" + coupling.leader +
                      "\": " + suggestion(coupling.leader, moving));
  }
  return coupling;
}

/// @throws std::invalid_argument if a joint follows itself by way of others
void requireNoCycle(const std::vector<Coupling>& couplings) {
  std::map<std::string, std::string> leaders;
  for (const Coupling& one : couplings) leaders[one.follower] = one.leader;
  for (const auto& one : leaders) {
    std::vector<std::string> chain = {one.first};
    while (leaders.count(chain.back()) > 0 && chain.size() <= leaders.size()) {
      chain.push_back(leaders[chain.back()]);
      if (chain.back() != one.first) continue;
      throw std::invalid_argument(
          "the joints " + join(chain, " -> ") +
          " mimic each other in a cycle: remove one <mimic>, so that one of "
          "them moves by itself");
    }
  }
}

/// @throws std::invalid_argument for what MuJoCo would ignore in the <mujoco> block of a URDF
void requireKnownBlock(const XMLElement& block) {
  const std::vector<std::string> elements = {"compiler", "option", "size"};
  for (const auto* one = block.FirstChildElement(); one != nullptr;
       one = one->NextSiblingElement()) {
    if (isOneOf(elements, one->Value())) continue;
    refuse(*one, "must not be in the <mujoco> block of a URDF, in which MuJoCo reads " +
                     join(elements, ", ") + " alone: leave it out, or write MJCF");
  }
  const std::vector<std::string> attributes = {
      "angle",         "assetdir",        "autolimits",        "balanceinertia",
      "boundinertia",  "boundmass",       "convexhull",        "coordinate",
      "discardvisual", "eulerseq",        "exactmeshinertia",  "fitaabb",
      "fusestatic",    "inertiafromgeom", "inertiagrouprange", "meshdir",
      "settotalmass",  "strippath",       "texturedir",        "usethread"};
  for (const XMLElement* compiler : children(block, "compiler")) {
    for (auto* one = compiler->FirstAttribute(); one != nullptr; one = one->Next()) {
      if (!isOneOf(attributes, one->Name())) {
        refuse(*compiler, std::string("has the attribute ") + one->Name() +
                              ", which MuJoCo ignores: " + suggestion(one->Name(), attributes));
      }
    }
    if (attribute(*compiler, "angle") == "degree") {
      refuse(
          *compiler,
          "has angle=\"degree\", which MuJoCo ignores in a URDF: URDF has radians; leave it out, "
          "and write the limits in radians");
    }
  }
}

/// MuJoCo would let a joint without limits, or with equal ones, move without end.
void requireLimits(const XMLElement& joint) {
  const bool turns = attribute(joint, "type") == "revolute";
  const XMLElement* const limit = joint.FirstChildElement("limit");
  const double lower = numberOr(joint, "limit", "lower", 0.0);
  const double upper = numberOr(joint, "limit", "upper", 0.0);
  const auto text = [limit](const char* end) {
    const bool given = limit != nullptr && limit->Attribute(end) != nullptr;
    return given ? "\"" + attribute(*limit, end) + "\"" : std::string("none");
  };
  if (!(lower < upper)) {
    refuse(joint, "is " + attribute(joint, "type") +
                      " and must have a <limit> with lower < upper, got " + text("lower") +
                      " and " + text("upper") + ": write them in " +
                      (turns ? "rad, or make the joint continuous (no limits) or fixed"
                             : "m, or make the joint fixed"));
  }
  if (turns && std::max(std::abs(lower), std::abs(upper)) > 4.0 * kPi) {
    refuse(joint, "must have limits within two turns, got " + text("lower") + " and " +
                      text("upper") +
                      ": URDF has radians; convert degrees, or make the joint continuous");
  }
}

/// Many files of robots have inertias that no body has, but nearly: there the smallest principal
/// inertia grows until it fits, and rotations about the other two axes keep theirs. MuJoCo would
/// put the mean of the three into the place of each.
void makePossible(XMLElement* link) {
  XMLElement* const inertial = link->FirstChildElement("inertial");
  XMLElement* const element =
      inertial == nullptr ? nullptr : inertial->FirstChildElement("inertia");
  if (element == nullptr) return;
  constexpr const char* kNames[3][3] = {
      {"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};
  Eigen::Matrix3d inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia(i, j) = numberOr(*inertial, "inertia", kNames[i][j], 0.0);
  }
  if (inertia.isZero(0.0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Vector3d principal = solver.eigenvalues();
  constexpr double kNearly = 2.0;
  constexpr double kSmallest = 1e-3;  // share of the largest
  if (principal[0] < -kSmallest * principal[2] ||
      principal[2] > kNearly * (principal[0] + principal[1])) {
    std::ostringstream got;
    got << principal[0] << ", " << principal[1] << ", " << principal[2];
    refuse(*link,
           "must have an <inertia> that a body can have: principal inertias > 0, none larger than "
           "the sum of the others, got " +
               got.str() + "; correct ixx to izz, which are about the centre of mass");
  }
  const double least = std::max(principal[2] - principal[1], kSmallest * principal[2]);
  if (principal[0] >= least) return;
  principal[0] = least + 1e-6 * principal[2];  // more than rounding takes away
  inertia = solver.eigenvectors() * principal.asDiagonal() * solver.eigenvectors().transpose();
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) element->SetAttribute(kNames[i][j], inertia(i, j));
  }
}

}  // namespace

Urdf readUrdf(const std::string& text, const std::string& path, const FindPackage& find_package) {
  const XmlDocument document = parseXml(text);
  XMLElement* const robot = document->RootElement();
  requireNoXacro(robot);
  keepWhatMujocoReads(robot);
  const std::vector<XMLElement*> links = children(*robot, "link");
  const std::vector<XMLElement*> joints = children(*robot, "joint");
  if (links.empty()) refuse(*robot, "has no <link>");
  requireNames(links);
  requireNames(joints);
  XMLElement* const mujoco = firstChild(robot, "mujoco");
  requireKnownBlock(*mujoco);
  for (const XMLElement* joint : joints) requireKnownType(*joint);
  requireTree(links, joints);
  Urdf urdf;
  for (XMLElement* joint : joints) {
    const std::string name = attribute(*joint, "name");
    const std::string type = attribute(*joint, "type");
    if (type == "fixed") {
      urdf.fixed[linkOf(*joint, "child")] = linkOf(*joint, "parent");
      continue;
    }
    if (const auto effort = number(*joint, "limit", "effort")) {
      if (*effort < 0.0) {
        refuse(*joint, "must have an effort >= 0, got \"" +
                           attribute(*joint->FirstChildElement("limit"), "effort") + "\"");
      }
      urdf.efforts[name] = *effort;
    }
    if (type == "continuous") {  // has no positions to end at, whatever is written
      for (XMLElement* limit : children(*joint, "limit")) {
        limit->DeleteAttribute("lower");
        limit->DeleteAttribute("upper");
      }
    } else {
      requireLimits(*joint);
    }
    if (joint->FirstChildElement("mimic") != nullptr) {
      urdf.couplings.push_back(couplingOf(*joint, joints));
    }
  }
  requireNoCycle(urdf.couplings);
  const XMLElement* const option = mujoco->FirstChildElement("option");
  const XMLElement* const flag = option == nullptr ? nullptr : option->FirstChildElement("flag");
  urdf.contacts = flag != nullptr && attribute(*flag, "contact") == "enable";
  XMLElement* const compiler = firstChild(mujoco, "compiler");
  if (compiler->Attribute("boundinertia") == nullptr &&
      compiler->Attribute("inertiafromgeom") == nullptr) {
    std::map<std::string, const XMLElement*> by_name;
    for (const XMLElement* link : links) by_name[attribute(*link, "name")] = link;
    for (const XMLElement* joint : joints) {
      if (attribute(*joint, "type") == "fixed") continue;
      requireInertia(linkOf(*joint, "child"), by_name, urdf.fixed);
    }
    if (attribute(*compiler, "balanceinertia") != "true") {
      for (XMLElement* link : links) {
        if (urdf.fixed.count(attribute(*link, "name")) == 0) makePossible(link);
      }
    }
  }
  MeshNames meshes(fs::absolute(path).parent_path(), find_package, compiler);
  for (const XMLElement* link : links) {
    for (const char* kind : {"visual", "collision"}) {
      for (const XMLElement* part : children(*link, kind)) {
        XMLElement* const shape = requireShape(*link, *part);
        if (std::string(shape->Value()) == "mesh") meshes.name(shape);
      }
    }
  }
  meshes.requireReadable();
  urdf.model.meshes = meshes.files;
  completeCompiler(compiler);
  urdf.model.path = path;
  urdf.model.text = xmlText(*document);
  return urdf;
}

}  // namespace ddm
