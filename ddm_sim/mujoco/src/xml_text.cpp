// XML of model files: read, and written again for MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include "xml_text.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace ddm {
namespace {

class Writer {
 public:
  std::string text;

  void write(const tinyxml2::XMLElement& element) {
    for (; line_ < element.GetLineNum(); ++line_) text += '\n';
    text += std::string("<") + element.Value();
    for (auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
      text += std::string(" ") + one->Name() + "=\"";
      writeValue(one->Value());
      text += '"';
    }
    text += '>';
    for (auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      write(*child);
    }
    text += std::string("</") + element.Value() + ">";
  }

 private:
  void writeValue(const std::string& value) {
    for (const char c : value) {
      switch (c) {
        case '&':
          text += "&amp;";
          break;
        case '<':
          text += "&lt;";
          break;
        case '"':
          text += "&quot;";
          break;
        default:
          text += c;
      }
    }
    line_ += static_cast<int>(std::count(value.begin(), value.end(), '\n'));
  }

  int line_ = 1;
};

}  // namespace

XmlDocument parseXml(const std::string& text) {
  auto document = std::make_unique<tinyxml2::XMLDocument>();
  if (document->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw std::invalid_argument("line " + std::to_string(document->ErrorLineNum()) +
                                " is not XML: " + document->ErrorStr());
  }
  if (document->RootElement() == nullptr) throw std::invalid_argument("it has no XML element");
  return document;
}

std::string xmlText(const tinyxml2::XMLDocument& document) {
  Writer writer;
  writer.write(*document.RootElement());
  return writer.text;
}

void forEachElement(tinyxml2::XMLElement* element,
                    const std::function<void(tinyxml2::XMLElement*)>& visit) {
  visit(element);
  for (auto* child = element->FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    forEachElement(child, visit);
  }
}

void forEachFile(tinyxml2::XMLElement* root,
                 const std::function<void(tinyxml2::XMLElement*, const std::string&)>& visit) {
  forEachElement(root, [&visit](tinyxml2::XMLElement* element) {
    const std::vector<std::string> kinds = {"mesh", "texture", "hfield", "skin"};
    if (std::find(kinds.begin(), kinds.end(), element->Value()) == kinds.end()) return;
    std::vector<std::string> names;  // `visit` may change their values
    for (auto* one = element->FirstAttribute(); one != nullptr; one = one->Next()) {
      if (std::string(one->Name()).rfind("file", 0) == 0) names.emplace_back(one->Name());
    }
    for (const std::string& name : names) visit(element, name);
  });
}

}  // namespace ddm
