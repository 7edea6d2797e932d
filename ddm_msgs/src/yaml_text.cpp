// YAML from a file that nobody vouches for.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_msgs/yaml_text.h"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace ddm {
namespace {

constexpr std::size_t kMaxLevels = 20;

[[noreturn]] void refuse(const std::string& source, const YAML::Mark& mark,
                         const std::string& what) {
  throw std::invalid_argument(source + ":" + std::to_string(mark.line + 1) + ": " + what);
}

/// Listens to the parser, which calls itself at each level, and stops it in time.
class Inspection : public YAML::EventHandler {
 public:
  explicit Inspection(const std::string& source) : source_(source) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++num_documents_ > 1) refuse(source_, mark, "only one YAML document is allowed in a file");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::find(open_.begin(), open_.end(), anchor) != open_.end()) {
      refuse(source_, mark, "a list or map contains itself");
    }
  }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
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
      refuse(source_, mark,
             "at most " + std::to_string(kMaxLevels) + " lists and maps may lie in each other");
    }
    open_.push_back(anchor);
  }

  const std::string& source_;
  int num_documents_ = 0;
  std::vector<YAML::anchor_t> open_;  // of the lists and maps that have begun
};

}  // namespace

YAML::Node parseYaml(const std::string& text, const std::string& source) {
  try {
    std::istringstream in(text);
    YAML::Parser parser(in);
    Inspection inspection(source);
    while (parser.HandleNextDocument(inspection)) {
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& e) {
    refuse(source, e.mark, "not valid YAML: " + e.msg);
  }
}

}  // namespace ddm
