// Rules for URDF files; each error message names element, line and remedy.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "xml_text.h"

namespace ddm {

// All functions of this file throw std::invalid_argument if a URDF breaks their rule.

inline bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> namesOf(const std::vector<XMLElement*>& elements);

/// Optional attribute `name` of the element `child` within `parent`. The number must be finite.
std::optional<double> number(const XMLElement& parent, const char* child, const char* name);

/// Same as number(), with 0 for a missing attribute.
double numberOrZero(const XMLElement& parent, const char* child, const char* name);

/// Name of the link in the element `parent` or `child` (argument `end`) of a joint.
std::string linkOf(const XMLElement& joint, const char* end);

/// Requires that all elements have names and that the names differ.
void requireNames(const std::vector<XMLElement*>& elements);

void requireNoXacro(XMLElement* root);

/// Requires a joint type that URDF defines and that a plant supports, and limits if the type needs
/// them. MuJoCo would let a joint without limits, or with equal limits, move without bounds.
void requireTypeAndLimits(const XMLElement& joint);

/// Requires that the joints connect all links to one tree.
void requireTree(const std::vector<XMLElement*>& links, const std::vector<XMLElement*>& joints);

/// Requires that a <visual> or <collision> has a shape that URDF defines, with valid sizes.
/// @return the shape
XMLElement* requireShape(const XMLElement& link, const XMLElement& part);

/// Requires that a moving link has mass and inertia, either its own or that of links that are fixed
/// to it.
/// @param fixed  links behind fixed joints, with their parents
void requireInertia(const std::string& link, const std::map<std::string, XMLElement*>& links,
                    const std::map<std::string, std::string>& fixed);

/// Requires that no joint follows itself through other joints.
/// @param leaders  leader of each joint that follows another joint
void requireNoCycle(const std::map<std::string, std::string>& leaders);

/// Requires that MuJoCo reads every element of the URDF's <mujoco> block.
void requireKnownBlock(const XMLElement& block);

}  // namespace ddm
