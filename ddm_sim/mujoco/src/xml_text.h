// XML of model files: read, and written again for MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml2.h>

#include <functional>
#include <memory>
#include <string>

namespace ddm {

using XmlDocument = std::unique_ptr<tinyxml2::XMLDocument>;

/// What a file is that was taken for another one, by its first bytes, with what helps: "is a web page:
/// ..."; empty if it is none of the usual ones.
std::string mistakenFor(const std::string& bytes);

/// @throws std::invalid_argument with the line and the reason if the text is not XML
XmlDocument parseXml(const std::string& text);

/// Elements and attributes of a document without comments. Each element starts in the line in which
/// it was read, so that errors of MuJoCo name the lines of the file.
std::string xmlText(const tinyxml2::XMLDocument& document);

/// Visits an element and all elements within it, outer ones first.
void forEachElement(tinyxml2::XMLElement* element,
                    const std::function<void(tinyxml2::XMLElement*)>& visit);

/// The value of an attribute; empty if there is none.
inline std::string attribute(const tinyxml2::XMLElement& element, const char* name) {
  const char* const value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

/// Attributes that name a file in elements that name one: meshes, textures, height fields, skins.
/// @param visit  gets the element and the name of the attribute
void forEachFile(tinyxml2::XMLElement* root,
                 const std::function<void(tinyxml2::XMLElement*, const std::string&)>& visit);

}  // namespace ddm
