// XML of model files: read, and written again for MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml2.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "refuse.h"

namespace ddm {

using tinyxml2::XMLElement;
using XmlDocument = std::unique_ptr<tinyxml2::XMLDocument>;

/// Says by the first bytes of a file that it is no model or mesh but, say, a web page, and what
/// helps: "is a web page: ...". Empty if it is none of the usual mistakes.
std::string mistakenFor(const std::string& bytes);

/// @throws std::invalid_argument with the line and the reason if the text is not XML
XmlDocument parseXml(const std::string& text);

/// Elements and attributes of a document without comments. Each element starts in the line in which
/// it was read, so that errors of MuJoCo name the lines of the file.
std::string xmlText(const tinyxml2::XMLDocument& document);

/// Visits an element and all elements within it, outer ones first.
void forEachElement(XMLElement* element, const std::function<void(XMLElement*)>& visit);

/// The elements of this name directly within an element.
std::vector<XMLElement*> children(const XMLElement& parent, const char* name);

/// The value of an attribute; empty if there is none.
inline std::string attribute(const XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

/// "<joint hinge> in line 7"
std::string placeOf(const XMLElement& element);

/// @throws std::invalid_argument, always: the element, its name and line, then the parts
template <class... Parts>
[[noreturn]] void refuseElement(const XMLElement& element, const Parts&... parts) {
  refuse(placeOf(element), " ", parts...);
}

}  // namespace ddm
