// What must hold in a URDF file, each rule with a message that names element, line and remedy.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "urdf.h"
#include "xml_text.h"

namespace ddm {

bool isOneOf(const std::vector<std::string>& names, const std::string& name);

/// @throws std::invalid_argument that begins with the element, its name and its line
[[noreturn]] void refuseElement(const tinyxml2::XMLElement& element, const std::string& what);

std::vector<tinyxml2::XMLElement*> children(const tinyxml2::XMLElement& parent, const char* name);

/// A number that an element within `parent` may have.
/// @throws std::invalid_argument if it is there and no finite number, as all functions below
std::optional<double> number(const tinyxml2::XMLElement& parent, const char* child,
                             const char* name);
double numberOr(const tinyxml2::XMLElement& parent, const char* child, const char* name,
                double none);

/// The link at the end `parent` or `child` of a joint.
std::string linkOf(const tinyxml2::XMLElement& joint, const char* end);

/// Each element has a name of its own.
void requireNames(const std::vector<tinyxml2::XMLElement*>& elements);

void requireNoXacro(tinyxml2::XMLElement* root);

/// A joint has a type that URDF has and that a plant can have.
void requireKnownType(const tinyxml2::XMLElement& joint);

/// Joints connect the links to one tree.
void requireTree(const std::vector<tinyxml2::XMLElement*>& links,
                 const std::vector<tinyxml2::XMLElement*>& joints);

/// A <visual> or <collision> has a shape that URDF has, with possible sizes.
/// @return the shape
tinyxml2::XMLElement* requireShape(const tinyxml2::XMLElement& link,
                                   const tinyxml2::XMLElement& part);

/// A link that a joint moves has mass and inertia, by itself or by the links that are fixed to it.
/// @param fixed  links behind fixed joints, and what they are fixed to
void requireInertia(const std::string& link,
                    const std::map<std::string, const tinyxml2::XMLElement*>& links,
                    const std::map<std::string, std::string>& fixed);

/// No joint follows itself by way of others.
void requireNoCycle(const std::vector<Coupling>& couplings);

/// MuJoCo ignores nothing in the <mujoco> block of a URDF.
void requireKnownBlock(const tinyxml2::XMLElement& block);

/// MuJoCo would let a joint without limits, or with equal ones, move without end.
void requireLimits(const tinyxml2::XMLElement& joint);

}  // namespace ddm
