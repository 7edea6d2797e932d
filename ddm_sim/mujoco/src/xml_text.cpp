// XML of model files: read, and written again for MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include "xml_text.h"

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <boost/locale/utf.hpp>
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

bool begins(const std::string& text, const std::string& word) {
  return text.compare(0, word.size(), word) == 0;
}

bool isUtf8(const std::string& text) {
  using boost::locale::utf::utf_traits;
  for (auto next = text.begin(); next != text.end();) {
    const auto code = utf_traits<char>::decode(next, text.end());
    if (!boost::locale::utf::is_valid_codepoint(code)) return false;
  }
  return true;
}

void requireUtf8(const tinyxml2::XMLElement& element) {
  for (auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    if (isUtf8(one->Value())) continue;
    throw std::invalid_argument("the attribute " + std::string(one->Name()) + " in line " +
                                std::to_string(element.GetLineNum()) +
                                " is not in UTF-8: convert the file, for example by `iconv -f "
                                "LATIN1 -t UTF-8 FILE > NEW_FILE`");
  }
}

/// Why a text that begins as XML is none, as far as it is known.
std::string whyBroken(const std::string& text) {
  if (text.find("\n<<<<<<< ") != std::string::npos) {
    return "; it has the marks of a merge conflict (<<<<<<<): resolve the conflict";
  }
  const std::size_t declaration = text.find("<?xml");
  return declaration != std::string::npos && text.find('<') < declaration
             ? "; <?xml must be the first in the file: move it up, or leave it out"
             : "";
}

}  // namespace

std::string mistakenFor(const std::string& bytes) {
  const std::pair<std::string, const char*> kinds[] = {
      {"version https://git-lfs",
       "is a pointer of Git LFS in the place of the file: run `git lfs pull` in its repository"},
      {"<!doctype html", "is a web page: download the raw file"},
      {"<html", "is a web page: download the raw file"},
      {"404", "is a web page: download the raw file"},
      {"pk\x03\x04", "is an archive: unpack it by `unzip`"},
      {"\x1f\x8b\x08", "is an archive: unpack it by `gunzip`"},
      {"\xff\xfe", "is in UTF-16: convert it by `iconv -f UTF-16 -t UTF-8 FILE > NEW_FILE`"},
      {"\xfe\xff", "is in UTF-16: convert it by `iconv -f UTF-16 -t UTF-8 FILE > NEW_FILE`"},
      {std::string("<\0", 2),
       "is in UTF-16: convert it by `iconv -f UTF-16 -t UTF-8 FILE > NEW_FILE`"},
      {"#usda", "is USD: export it as URDF or MJCF"},
      {"pxr-usdc", "is USD: export it as URDF or MJCF"}};
  const std::string first = boost::to_lower_copy(boost::trim_left_copy(bytes.substr(0, 1000)));
  if (first.empty()) return "is empty: fetch or write it again";
  for (const auto& kind : kinds) {
    if (begins(first, kind.first)) return kind.second;
  }
  return "";
}

XmlDocument parseXml(const std::string& text) {
  const std::string mistaken = mistakenFor(text);
  if (!mistaken.empty()) throw std::invalid_argument("it " + mistaken);
  if (begins(text, "solid") || text.find('\0') != std::string::npos) {
    throw std::invalid_argument(
        "it is no XML: if it is a mesh, name the URDF or MJCF file that uses it");
  }
  auto document = std::make_unique<tinyxml2::XMLDocument>();
  if (document->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw std::invalid_argument("line " + std::to_string(document->ErrorLineNum()) +
                                " is not XML: " + document->ErrorStr() + whyBroken(text));
  }
  if (document->RootElement() == nullptr) throw std::invalid_argument("it has no XML element");
  forEachElement(document->RootElement(),
                 [](tinyxml2::XMLElement* element) { requireUtf8(*element); });
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
