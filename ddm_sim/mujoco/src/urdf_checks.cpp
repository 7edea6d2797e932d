// Rules for URDF files; each error message names element, line and remedy.
// SPDX-License-Identifier: BSD-3-Clause
#include "urdf_checks.h"

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <set>
#include <sstream>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_sim/plant.h"

namespace ddm {
namespace {

using boost::algorithm::join;

/// Requires positive sizes. A mirrored mesh may have a negative scale.
void requireSizes(const XMLElement& link, const XMLElement& shape) {
  for (const char* name : {"size", "radius", "length", "scale"}) {
    std::istringstream in(attribute(shape, name));
    const bool scale = std::string(name) == "scale";
    for (double number = 0.0; in >> number;) {
      if (number > 0.0 || (scale && number < 0.0)) continue;
      refuseElement(shape, "of the link ", attribute(link, "name"), " must have a ", name,
                    scale ? " without 0" : " > 0", ", got \"", attribute(shape, name),
                    "\": correct it, or leave the shape out");
    }
  }
}

void requireLimits(const XMLElement& joint) {
  const bool turns = attribute(joint, "type") == "revolute";
  const double lower = numberOrZero(joint, "limit", "lower");
  const double upper = numberOrZero(joint, "limit", "upper");
  const auto text = [&joint](const char* end) {
    const XMLElement* const limit = joint.FirstChildElement("limit");
    const bool given = limit != nullptr && limit->Attribute(end) != nullptr;
    return given ? "\"" + attribute(*limit, end) + "\"" : std::string("none");
  };
  if (!(lower < upper)) {
    refuseElement(joint, "is ", attribute(joint, "type"),
                  " and must have a <limit> with lower < upper, got ", text("lower"), " and ",
                  text("upper"), ": write them in ",
                  turns ? "rad, or make the joint continuous (no limits) or fixed"
                        : "m, or make the joint fixed");
  }
  if (turns && std::max(std::abs(lower), std::abs(upper)) > 4.0 * kPi) {
    refuseElement(joint, "must have limits within two turns, got ", text("lower"), " and ",
                  text("upper"),
                  ": URDF has radians; convert degrees, or make the joint continuous");
  }
}

}  // namespace

std::vector<std::string> namesOf(const std::vector<XMLElement*>& elements) {
  std::vector<std::string> names;
  for (const XMLElement* element : elements) names.push_back(attribute(*element, "name"));
  return names;
}

std::optional<double> number(const XMLElement& parent, const char* child, const char* name) {
  const XMLElement* const element = parent.FirstChildElement(child);
  const char* const text = element == nullptr ? nullptr : element->Attribute(name);
  if (text == nullptr) return std::nullopt;
  std::istringstream in(text);
  double value = 0.0;
  if (in >> value && (in >> std::ws).eof() && std::isfinite(value)) return value;
  refuseElement(parent, "must have a finite number for ", name, " in <", child, ">, got \"", text,
                "\"");
}

double numberOrZero(const XMLElement& parent, const char* child, const char* name) {
  return number(parent, child, name).value_or(0.0);
}

std::string linkOf(const XMLElement& joint, const char* end) {
  const XMLElement* const element = joint.FirstChildElement(end);
  const std::string link = element == nullptr ? "" : attribute(*element, "link");
  if (link.empty()) refuseElement(joint, "must have <", end, " link=\"...\"/>");
  return link;
}

void requireNames(const std::vector<XMLElement*>& elements) {
  std::set<std::string> names;
  for (const XMLElement* element : elements) {
    const std::string name = attribute(*element, "name");
    if (name.empty()) refuseElement(*element, "must have a name");
    if (names.insert(name).second) continue;
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
    refuseModel("line ", element->GetLineNum(), " has ", found,
                ", this is xacro: run xacro FILE > robot.urdf, and name that file");
  });
}

void requireTypeAndLimits(const XMLElement& joint) {
  const std::vector<std::string> types = {"revolute", "continuous", "prismatic",
                                          "fixed",    "floating",   "planar"};
  const std::string type = attribute(joint, "type");
  if (type == "floating" || type == "planar") {
    refuseElement(
        joint, "is ", type,
        ", and a plant of a model file has hinges and slides alone: make it fixed, or put "
        "prismatic, continuous or revolute joints in its place");
  }
  if (!isOneOf(types, type)) {
    const std::string lower = boost::to_lower_copy(type);
    refuseElement(joint, "must have one of the types of URDF, which are ", join(types, ", "),
                  ", got ", type.empty() ? "none" : "\"" + type + "\"",
                  isOneOf(types, lower) ? ": did you mean " + lower + "?" : "");
  }
  if (type == "revolute" || type == "prismatic") requireLimits(joint);
}

void requireTree(const std::vector<XMLElement*>& links, const std::vector<XMLElement*>& joints) {
  const std::vector<std::string> names = namesOf(links);
  std::map<std::string, const XMLElement*> to_parent;
  for (const XMLElement* joint : joints) {
    for (const char* end : {"parent", "child"}) {
      const std::string link = linkOf(*joint, end);
      if (isOneOf(names, link)) continue;
      refuseElement(*joint, "names the ", end, " link ", link,
                    ", which is not declared: add <link name=\"", link, "\"/>, or ",
                    suggestion(link, names));
    }
    const std::string child = linkOf(*joint, "child");
    if (child == "world") {
      refuseElement(*joint,
                    "has the child link world, which MuJoCo takes for the ground: rename the link");
    }
    if (!to_parent.emplace(child, joint).second) {
      refuseElement(*joint, "has the child link ", child, ", which is already that of the joint ",
                    attribute(*to_parent[child], "name"), ": a link has one parent");
    }
  }
  std::vector<std::string> roots;
  for (const std::string& name : names) {
    std::set<std::string> seen;
    std::string link = name;
    for (; to_parent.count(link) > 0; link = linkOf(*to_parent[link], "parent")) {
      if (seen.insert(link).second) continue;
      refuseElement(*to_parent[link], "closes a cycle of links through ", link,
                    ": URDF has trees alone; remove one joint of the cycle");
    }
    if (!isOneOf(roots, link)) roots.push_back(link);
  }
  if (roots.size() == 1) return;
  refuseModel("the robot must have one root link, got ", join(roots, ", "),
              ": connect these links by fixed joints, or remove those of no use");
}

XMLElement* requireShape(const XMLElement& link, const XMLElement& part) {
  const XMLElement* const geometry = part.FirstChildElement("geometry");
  auto* const shape =
      const_cast<XMLElement*>(geometry == nullptr ? nullptr : geometry->FirstChildElement());
  const std::string name = shape == nullptr ? "nothing" : shape->Value();
  if (isOneOf({"box", "cylinder", "sphere", "mesh"}, name)) {
    requireSizes(link, *shape);
    return shape;
  }
  refuseElement(part, "of the link ", attribute(link, "name"),
                " must have a <geometry> of box, cylinder, sphere or mesh, got ", name,
                name == "capsule"
                    ? ": URDF has no capsules; make it a cylinder and two spheres, or write MJCF"
                    : "");
}

void requireInertia(const std::string& link, const std::map<std::string, XMLElement*>& links,
                    const std::map<std::string, std::string>& fixed) {
  const XMLElement& moved = *links.at(link);
  const auto valueOf = [](const XMLElement& one, const char* child, const char* name) {
    const XMLElement* const inertial = one.FirstChildElement("inertial");
    return inertial == nullptr ? 0.0 : numberOrZero(*inertial, child, name);
  };
  std::string point_mass;
  for (const auto& one : fixed) {
    std::string parent = one.first;
    while (parent != link && fixed.count(parent) > 0) parent = fixed.at(parent);
    const XMLElement& carried = *links.at(one.first);
    if (parent != link || valueOf(carried, "mass", "value") <= 0.0) continue;
    if (valueOf(carried, "inertia", "ixx") > 0.0) return;
    point_mass = " (the link " + one.first + ", which is fixed to it, is a point mass)";
  }
  if (moved.FirstChildElement("inertial") == nullptr) {
    refuseElement(moved, "is moved by a joint and has no <inertial>", point_mass,
                  ": give it a mass and an inertia");
  }
  const double mass = valueOf(moved, "mass", "value");
  if (mass <= 0.0) {
    refuseElement(moved, "is moved by a joint and must have a mass > 0 in its <inertial>, got ",
                  mass);
  }
  for (const char* axis : {"ixx", "iyy", "izz"}) {
    const double inertia = valueOf(moved, "inertia", axis);
    if (inertia > 0.0) continue;
    refuseElement(moved, "is moved by a joint and must have inertias > 0, got ", inertia, " for ",
                  axis, ": a point mass cannot be simulated; give it the inertia of its shape");
  }
}

void requireNoCycle(const std::map<std::string, std::string>& leaders) {
  for (const auto& one : leaders) {
    std::vector<std::string> chain = {one.first};
    while (leaders.count(chain.back()) > 0 && chain.size() <= leaders.size()) {
      chain.push_back(leaders.at(chain.back()));
      if (chain.back() != one.first) continue;
      refuseModel(
          "the joints ", join(chain, " -> "),
          " mimic each other in a cycle: remove one <mimic>, so that one of them moves by itself");
    }
  }
}

void requireKnownBlock(const XMLElement& block) {
  const std::vector<std::string> elements = {"compiler", "option", "size"};
  for (const XMLElement* one : children(block)) {
    if (isOneOf(elements, one->Value())) continue;
    refuseElement(*one, "must not be in the <mujoco> block of a URDF, in which MuJoCo reads ",
                  join(elements, ", "), " alone: leave it out, or write MJCF");
  }
  const std::vector<std::string> attributes = {
      "angle",         "assetdir",        "autolimits",        "balanceinertia",
      "boundinertia",  "boundmass",       "convexhull",        "coordinate",
      "discardvisual", "eulerseq",        "exactmeshinertia",  "fitaabb",
      "fusestatic",    "inertiafromgeom", "inertiagrouprange", "meshdir",
      "settotalmass",  "strippath",       "texturedir",        "usethread"};
  for (const XMLElement* compiler : children(block, "compiler")) {
    for (auto* one = compiler->FirstAttribute(); one != nullptr; one = one->Next()) {
      if (isOneOf(attributes, one->Name())) continue;
      refuseElement(*compiler, "has the attribute ", one->Name(),
                    ", which MuJoCo ignores: ", suggestion(one->Name(), attributes));
    }
    if (attribute(*compiler, "angle") == "degree") {
      refuseElement(*compiler,
                    "has angle=\"degree\", which MuJoCo ignores in a URDF: URDF has radians; leave "
                    "it out, and write the limits in radians");
    }
  }
}

}  // namespace ddm
