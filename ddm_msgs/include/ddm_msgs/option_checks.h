// Collects what is wrong with the values of a block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ddm {

// Written so that NaN fails; an infinite length or mass has no physics either.
inline bool isPositive(double value) {
  return value > 0.0 && value <= std::numeric_limits<double>::max();
}
inline bool isNotNegative(double value) {
  return value >= 0.0 && value <= std::numeric_limits<double>::max();
}

/// Collects the problems of one block, each as "block/key must <rule>, got <value>".
class OptionChecks {
 public:
  explicit OptionChecks(std::string block) : block_(std::move(block)) {}

  /// @param ok  to be written so that NaN makes it false
  template <class Value>
  void require(bool ok, const std::string& key, const std::string& rule, const Value& value) {
    if (ok) return;
    std::ostringstream problem;
    problem << block_ << '/' << key << " must " << rule << ", got " << value;
    problems_.push_back(problem.str());
  }

  template <class Value>
  void requireWithin(const std::string& key, Value value, Value lowest, Value highest) {
    std::ostringstream rule;
    rule << "lie in [" << lowest << ", " << highest << "]";
    require(value >= lowest && value <= highest, key, rule.str(), value);
  }
  void requireAtLeast(const std::string& key, int value, int lowest) {
    require(value >= lowest, key, "be >= " + std::to_string(lowest), value);
  }
  void requirePositive(const std::string& key, double value) {
    require(isPositive(value), key, "be > 0 and finite", value);
  }
  void requireNotNegative(const std::string& key, double value) {
    require(isNotNegative(value), key, "be >= 0 and finite", value);
  }

  void requireFraction(const std::string& key, double value) {
    require(value >= 0.0 && value < 1.0, key, "lie in [0, 1)", value);
  }

  void add(const std::vector<std::string>& problems) {
    problems_.insert(problems_.end(), problems.begin(), problems.end());
  }

  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::string block_;
  std::vector<std::string> problems_;
};

/// @throws std::invalid_argument with all of the problems, one a line, if there are any
inline void requireNone(const std::vector<std::string>& problems) {
  if (problems.empty()) return;
  std::string all;
  for (const std::string& problem : problems) all += "\n- " + problem;
  throw std::invalid_argument("invalid options:" + all);
}

/// `options` unchanged, so that the checks precede the first use of its values.
/// @throws std::invalid_argument with all of its problems
template <class Options>
const Options& checked(const Options& options) {
  requireNone(options.problems());
  return options;
}

}  // namespace ddm
