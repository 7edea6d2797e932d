// Rules that the options of a block must keep, and what to tell where they do not.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace ddm {
namespace pilco {

/// Collects everything wrong with a block of options.
class OptionRules {
 public:
  /// @param block  its name in YAML
  explicit OptionRules(std::string block) : block_(std::move(block)) {}

  /// @param ok    to be written so that NaN makes it false
  /// @param rule  starts with the name of the option
  template <class Value>
  void require(bool ok, const char* rule, const Value& value) {
    if (ok) return;
    std::ostringstream text;
    text << block_ << "/" << rule << ", got " << value;
    problems_.push_back(text.str());
  }

  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::string block_;
  std::vector<std::string> problems_;
};

}  // namespace pilco
}  // namespace ddm
