// What must hold in a URDF file, each rule with a message that names element, line and remedy.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "xml_text.h"

namespace ddm {

// All functions throw std::invalid_argument if their rule is broken.

inline bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> namesOf(const std::vector<XMLElement*>& elements);

/// A number that an element within `parent` may have. If it is there, it must be finite.
std::optional<double> number(const XMLElement& parent, const char* child, const char* name);

/// As number(); 0 if it is not there.
double numberOrZero(const XMLElement& parent, const char* child, const char* name);

/// The link at the end `parent` or `child` of a joint.
std::string linkOf(const XMLElement& joint, const char* end);

/// Each element has a name of its own.
void requireNames(const std::vector<XMLElement*>& elements);

void requireNoXacro(XMLElement* root);

/// A joint has a type that URDF has and that a plant can have. It has limits if its type needs them:
/// MuJoCo would let a joint without limits, or with equal ones, move without end.
void requireTypeAndLimits(const XMLElement& joint);

/// Joints connect the links to one tree.
void requireTree(const std::vector<XMLElement*>& links, const std::vector<XMLElement*>& joints);

/// A <visual> or <collision> has a shape that URDF has, with possible sizes.
/// @return the shape
XMLElement* requireShape(const XMLElement& link, const XMLElement& part);

/// A link that a joint moves has mass and inertia, by itself or by the links that are fixed to it.
/// @param fixed  links behind fixed joints, and what they are fixed to
void requireInertia(const std::string& link, const std::map<std::string, XMLElement*>& links,
                    const std::map<std::string, std::string>& fixed);

/// No joint follows itself by way of others.
/// @param leaders  of the joints that follow another one
void requireNoCycle(const std::map<std::string, std::string>& leaders);

/// MuJoCo reads all that the <mujoco> block of a URDF says.
void requireKnownBlock(const XMLElement& block);

}  // namespace ddm
