// Reads the XML of model files, and writes it for MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml2.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {

using tinyxml2::XMLElement;
using XmlDocument = std::unique_ptr<tinyxml2::XMLDocument>;

/// Recognises from its first bytes a file that is neither model nor mesh, for example a web page.
/// Returns the description and the remedy: "is a web page: ...". Empty if the bytes match none of
/// the known mistakes.
std::string mistakenFor(const std::string& bytes);

/// @throws std::invalid_argument with the line and the reason if the text is not XML
XmlDocument parseXml(const std::string& text);

/// Writes the elements and attributes of a document, without comments. Each element starts in its
/// original line, so that the line numbers in MuJoCo's errors are those of the file.
std::string xmlText(const tinyxml2::XMLDocument& document);

/// Calls `visit` for an element and for all elements within it, outer elements first.
void forEachElement(XMLElement* element, const std::function<void(XMLElement*)>& visit);

/// Child elements with this name, or all child elements; deeper levels are not searched.
std::vector<XMLElement*> children(const XMLElement& parent, const char* name = nullptr);

/// Value of an attribute. Empty if the attribute does not exist.
inline std::string attribute(const XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

/// "<joint hinge> in line 7"
std::string placeOf(const XMLElement& element);

/// @throws std::invalid_argument with the element's name and line, then the parts; the function
///         never returns
template <class... Parts>
[[noreturn]] void refuseElement(const XMLElement& element, const Parts&... parts) {
  refuseModel(placeOf(element), " ", parts...);
}

}  // namespace ddm
