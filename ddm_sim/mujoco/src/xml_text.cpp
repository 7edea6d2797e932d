// Reads the XML of model files, and writes it for MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include "xml_text.h"

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <boost/locale/utf.hpp>
#include <utility>

namespace ddm {
namespace {

/// Prints elements without text and comments, each in its original line.
class LinePrinter : public tinyxml2::XMLPrinter {
 public:
  LinePrinter() : XMLPrinter(nullptr, /*compact=*/true) {}

  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute* first) override {
    for (; line_ < element.GetLineNum(); ++line_) PushText("\n");
    for (auto* one = first; one != nullptr; one = one->Next()) {
      const std::string value = one->Value();
      line_ += static_cast<int>(std::count(value.begin(), value.end(), '\n'));
    }
    return XMLPrinter::VisitEnter(element, first);
  }
  bool Visit(const tinyxml2::XMLText& /*text*/) override { return true; }
  bool Visit(const tinyxml2::XMLComment& /*comment*/) override { return true; }
  bool Visit(const tinyxml2::XMLDeclaration& /*declaration*/) override { return true; }
  bool Visit(const tinyxml2::XMLUnknown& /*unknown*/) override { return true; }

 private:
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

void requireUtf8(const XMLElement& element) {
  for (auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    if (isUtf8(one->Value())) continue;
    refuseModel(
        "the attribute ", one->Name(), " in line ", element.GetLineNum(),
        " is not in UTF-8: convert the file, for example by `iconv -f LATIN1 -t UTF-8 FILE > "
        "NEW_FILE`");
  }
}

/// Likely reason why a text that begins like XML cannot be parsed. Empty if the reason is unknown.
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
  constexpr char kWebPage[] = "is a web page: download the raw file";
  constexpr char kUtf16[] =
      "is in UTF-16: convert it by `iconv -f UTF-16 -t UTF-8 FILE > NEW_FILE`";
  constexpr char kUsd[] = "is USD: export it as URDF or MJCF";
  const std::pair<std::string, const char*> kinds[] = {
      {"version https://git-lfs",
       "is a pointer of Git LFS in the place of the file: run `git lfs pull` in its repository"},
      {"<!doctype html", kWebPage},
      {"<html", kWebPage},
      {"404", kWebPage},
      {"pk\x03\x04", "is an archive: unpack it by `unzip`"},
      {"\x1f\x8b\x08", "is an archive: unpack it by `gunzip`"},
      {"\xff\xfe", kUtf16},
      {"\xfe\xff", kUtf16},
      {std::string("<\0", 2), kUtf16},
      {"#usda", kUsd},
      {"pxr-usdc", kUsd}};
  const std::string first = boost::to_lower_copy(boost::trim_left_copy(bytes.substr(0, 1000)));
  if (first.empty()) return "is empty: fetch or write it again";
  for (const auto& kind : kinds) {
    if (begins(first, kind.first)) return kind.second;
  }
  return "";
}

XmlDocument parseXml(const std::string& text) {
  const std::string mistaken = mistakenFor(text);
  if (!mistaken.empty()) refuseModel("it ", mistaken);
  if (begins(text, "solid") || text.find('\0') != std::string::npos) {
    refuseModel("it is no XML: if it is a mesh, name the URDF or MJCF file that uses it");
  }
  auto document = std::make_unique<tinyxml2::XMLDocument>();
  if (document->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    refuseModel("line ", document->ErrorLineNum(), " is not XML: ", document->ErrorStr(),
                whyBroken(text));
  }
  if (document->RootElement() == nullptr) refuseModel("it has no XML element");
  forEachElement(document->RootElement(), [](XMLElement* element) { requireUtf8(*element); });
  return document;
}

std::string xmlText(const tinyxml2::XMLDocument& document) {
  LinePrinter printer;
  document.RootElement()->Accept(&printer);
  return printer.CStr();
}

void forEachElement(XMLElement* element, const std::function<void(XMLElement*)>& visit) {
  visit(element);
  for (XMLElement* child : children(*element)) forEachElement(child, visit);
}

std::vector<XMLElement*> children(const XMLElement& parent, const char* name) {
  std::vector<XMLElement*> out;
  for (auto* child = parent.FirstChildElement(name); child != nullptr;
       child = child->NextSiblingElement(name)) {
    out.push_back(const_cast<XMLElement*>(child));
  }
  return out;
}

std::string placeOf(const XMLElement& element) {
  const std::string name = attribute(element, "name");
  return textOf("<", element.Value(), name.empty() ? "" : " ", name, "> in line ",
                element.GetLineNum());
}

}  // namespace ddm
