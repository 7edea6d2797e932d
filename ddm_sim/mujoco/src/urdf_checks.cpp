// What must hold in a URDF file, each rule with a message that names element, line and remedy.
// SPDX-License-Identifier: BSD-3-Clause
#include "urdf_checks.h"

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>
#include <stdexcept>

#include "ddm_sim/angles.h"

namespace ddm {

using boost::algorithm::join;
using tinyxml2::XMLElement;

namespace {

const std::vector<std::string> kJointTypes = {"revolute", "continuous", "prismatic",
                                              "fixed",    "floating",   "planar"};
const std::vector<std::string> kShapes = {"box", "cylinder", "sphere", "mesh"};

/// "<joint hinge> in line 7"
std::string placeOf(const XMLElement& element) {
  const std::string name = attribute(element, "name");
  return std::string("<") + element.Value() + (name.empty() ? "" : " " + name) + "> in line " +
         std::to_string(element.GetLineNum());
}

/// Sizes are positive; a mesh that is mirrored has a negative scale.
void requireSizes(const XMLElement& link, const XMLElement& shape) {
  for (const char* name : {"size", "radius", "length", "scale"}) {
    std::istringstream in(attribute(shape, name));
    in.imbue(std::locale::classic());
    for (double number = 0.0; in >> number;) {
      const bool scale = std::string(name) == "scale";
      if (number > 0.0 || (scale && number < 0.0)) continue;
      refuseElement(shape, "of the link " + attribute(link, "name") + " must have a " + name +
                               (scale ? " without 0" : " > 0") + ", got \"" +
                               attribute(shape, name) + "\": correct it, or leave the shape out");
    }
  }
}

}  // namespace

bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

[[noreturn]] void refuseElement(const XMLElement& element, const std::string& what) {
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

std::optional<double> number(const XMLElement& parent, const char* child, const char* name) {
  const XMLElement* const element = parent.FirstChildElement(child);
  const char* const text = element == nullptr ? nullptr : element->Attribute(name);
  if (text == nullptr) return std::nullopt;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  double value = 0.0;
  if (in >> value && (in >> std::ws).eof() && std::isfinite(value)) return value;
  refuseElement(parent, std::string("must have a finite number for ") + name + " in <" + child +
                            ">, got \"" + text + "\"");
}

double numberOr(const XMLElement& parent, const char* child, const char* name, double none) {
  return number(parent, child, name).value_or(none);
}

std::string linkOf(const XMLElement& joint, const char* end) {
  const XMLElement* const element = joint.FirstChildElement(end);
  const std::string link = element == nullptr ? "" : attribute(*element, "link");
  if (link.empty()) refuseElement(joint, std::string("must have <") + end + " link=\"...\"/>");
  return link;
}

void requireNames(const std::vector<XMLElement*>& elements) {
  std::set<std::string> names;
  for (const XMLElement* element : elements) {
    const std::string name = attribute(*element, "name");
    if (name.empty()) refuseElement(*element, "must have a name");
    if (!names.insert(name).second)
      refuseElement(*element, "has the name of another one: rename it");
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
    refuseElement(
        joint, "is " + type +
                   ", and a plant of a model file has hinges and slides alone: make it fixed, or "
                   "put prismatic, continuous or revolute joints in its place");
  }
  if (isOneOf(kJointTypes, type)) return;
  const std::string lower = boost::to_lower_copy(type);
  refuseElement(joint, "must have one of the types of URDF, which are " + join(kJointTypes, ", ") +
                           ", got " + (type.empty() ? "none" : "\"" + type + "\"") +
                           (isOneOf(kJointTypes, lower) ? ": did you mean " + lower + "?" : ""));
}

void requireTree(const std::vector<XMLElement*>& links, const std::vector<XMLElement*>& joints) {
  std::vector<std::string> names;
  for (const XMLElement* link : links) names.push_back(attribute(*link, "name"));
  std::map<std::string, const XMLElement*> to_parent;
  for (const XMLElement* joint : joints) {
    for (const char* end : {"parent", "child"}) {
      const std::string link = linkOf(*joint, end);
      if (isOneOf(names, link)) continue;
      refuseElement(*joint, std::string("names the ") + end + " link " + link +
                                ", which is not declared: add <link name=\"" + link + "\"/>, or " +
                                suggestion(link, names));
    }
    const std::string child = linkOf(*joint, "child");
    if (child == "world") {
      refuseElement(*joint,
                    "has the child link world, which MuJoCo takes for the ground: rename the link");
    }
    if (!to_parent.emplace(child, joint).second) {
      refuseElement(*joint, "has the child link " + child +
                                ", which is already that of the joint " +
                                attribute(*to_parent[child], "name") + ": a link has one parent");
    }
  }
  for (const std::string& name : names) {
    std::set<std::string> seen;
    for (std::string link = name; to_parent.count(link) > 0;) {
      if (!seen.insert(link).second) {
        refuseElement(*to_parent[link],
                      "closes a cycle of links through " + link +
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

XMLElement* requireShape(const XMLElement& link, const XMLElement& part) {
  const XMLElement* const geometry = part.FirstChildElement("geometry");
  auto* const shape =
      const_cast<XMLElement*>(geometry == nullptr ? nullptr : geometry->FirstChildElement());
  const std::string name = shape == nullptr ? "nothing" : shape->Value();
  if (isOneOf(kShapes, name)) {
    requireSizes(link, *shape);
    return shape;
  }
  refuseElement(
      part, "of the link " + attribute(link, "name") +
                " must have a <geometry> of box, cylinder, sphere or mesh, got " + name +
                (name == "capsule"
                     ? ": URDF has no capsules; make it a cylinder and two spheres, or write MJCF"
                     : ""));
}

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
    refuseElement(moved, "is moved by a joint and has no <inertial>" + point_mass +
                             ": give it a mass and an inertia");
  }
  if (massOf(moved) <= 0.0) {
    refuseElement(moved, "is moved by a joint and must have a mass > 0 in its <inertial>, got " +
                             std::to_string(massOf(moved)));
  }
  for (const char* axis : {"ixx", "iyy", "izz"}) {
    const double inertia = numberOr(*inertial, "inertia", axis, 0.0);
    if (inertia > 0.0) continue;
    refuseElement(moved,
                  std::string("is moved by a joint and must have inertias > 0, got ") +
                      (inertia == 0.0 ? "0" : std::to_string(inertia)) + " for " + axis +
                      ": a point mass cannot be simulated; give it the inertia of its shape");
  }
}

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

void requireKnownBlock(const XMLElement& block) {
  const std::vector<std::string> elements = {"compiler", "option", "size"};
  for (const auto* one = block.FirstChildElement(); one != nullptr;
       one = one->NextSiblingElement()) {
    if (isOneOf(elements, one->Value())) continue;
    refuseElement(*one, "must not be in the <mujoco> block of a URDF, in which MuJoCo reads " +
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
        refuseElement(*compiler,
                      std::string("has the attribute ") + one->Name() +
                          ", which MuJoCo ignores: " + suggestion(one->Name(), attributes));
      }
    }
    if (attribute(*compiler, "angle") == "degree") {
      refuseElement(
          *compiler,
          "has angle=\"degree\", which MuJoCo ignores in a URDF: URDF has radians; leave it out, "
          "and write the limits in radians");
    }
  }
}

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
    refuseElement(joint, "is " + attribute(joint, "type") +
                             " and must have a <limit> with lower < upper, got " + text("lower") +
                             " and " + text("upper") + ": write them in " +
                             (turns ? "rad, or make the joint continuous (no limits) or fixed"
                                    : "m, or make the joint fixed"));
  }
  if (turns && std::max(std::abs(lower), std::abs(upper)) > 4.0 * kPi) {
    refuseElement(joint, "must have limits within two turns, got " + text("lower") + " and " +
                             text("upper") +
                             ": URDF has radians; convert degrees, or make the joint continuous");
  }
}

}  // namespace ddm
