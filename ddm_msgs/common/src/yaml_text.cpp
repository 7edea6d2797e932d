// Parses YAML from untrusted files, and prints YAML values in messages.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/yaml_text.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <boost/locale/utf.hpp>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "ddm_common/option_checks.h"

namespace ddm {
namespace {

namespace utf = boost::locale::utf;

constexpr std::size_t kMaxLevels = 20;

/// Whether yaml-cpp prints a text as it was read. yaml-cpp replaces bytes that are not UTF-8, and
/// code points that are no characters.
bool isText(const std::string& text) {
  for (auto at = text.begin(); at != text.end();) {
    const std::uint32_t code = utf::utf_traits<char>::decode(at, text.end());
    const bool no_character = (code >= 0xfdd0 && code <= 0xfdef) || (code & 0xfffe) == 0xfffe;
    if (!utf::is_valid_codepoint(code) || no_character) return false;
  }
  return true;
}

/// Refuses a ':' directly before ']' or the character 4, which yaml-cpp uses as its end of file.
/// yaml-cpp 0.6 (Debian 11, Noetic) never returns from either. Quotes and comments are no
/// exception, because only the parser of YAML knows where they begin.
void refuseColonBeforeEnd(const std::string& text, const std::string& source) {
  const std::size_t at = std::min(text.find(":]"), text.find(":\4"));
  if (at == std::string::npos) return;
  YAML::Mark mark;
  mark.line = static_cast<int>(std::count(text.begin(), text.begin() + at, '\n'));
  refuseAt(source, mark, "a ':' must not stand directly before ']': add a value or a blank");
}

/// Event handler that stops the recursive parser before the document becomes too deep.
class Inspection : public YAML::EventHandler {
 public:
  explicit Inspection(const std::string& source) : source_(source) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++num_documents_ > 1)
      refuseAt(source_, mark, "only one YAML document is allowed in a file");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::find(open_.begin(), open_.end(), anchor) != open_.end()) {
      refuseAt(source_, mark, "a list or map contains itself");
    }
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& text) override {
    if (!isText(text)) refuseAt(source_, mark, "a name or value is not valid UTF-8");
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (open_.size() == kMaxLevels) {
      refuseAt(source_, mark,
               textOf("at most ", kMaxLevels, " lists and maps may lie in each other"));
    }
    open_.push_back(anchor);
  }

  const std::string& source_;
  int num_documents_ = 0;
  std::vector<YAML::anchor_t> open_;  // anchors of the lists and maps that are not closed yet
};

}  // namespace

void refuseAt(const std::string& source, const YAML::Mark& mark, const std::string& what) {
  throw std::invalid_argument(textOf(source, ":", mark.line + 1, ": ", what));
}

YAML::Node parseYaml(const std::string& text, const std::string& source) {
  const std::string lines = text + "\n";  // so that no ':' is at the end
  refuseColonBeforeEnd(lines, source);
  try {
    std::istringstream in(lines);
    YAML::Parser parser(in);
    Inspection inspection(source);
    while (parser.HandleNextDocument(inspection)) {
    }
    return YAML::Load(lines);
  } catch (const YAML::Exception& e) {
    refuseAt(source, e.mark, "not valid YAML: " + e.msg);
  }
}

std::string oneLine(const YAML::Node& node) {
  constexpr std::size_t kMaxLength = 120;
  if (node.IsNull()) return "nothing";
  if (node.IsScalar() && node.Scalar().empty()) return "an empty text";
  std::string text;
  if (node.IsScalar()) {
    text = node.Scalar();
  } else {
    YAML::Node copy = YAML::Clone(node);
    copy.SetStyle(YAML::EmitterStyle::Flow);
    text = YAML::Dump(copy);
  }
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  std::replace_if(text.begin(), text.end(), is_control, ' ');
  return text.size() <= kMaxLength ? text : text.substr(0, kMaxLength) + "...";
}

}  // namespace ddm
