// Builds error messages: the invalid values of a block, and the correct spelling of a name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ddm {

/// Concatenates the parts; numbers are written as a stream writes them.
template <class... Parts>
std::string textOf(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

// NaN and infinity are refused: no length or mass is infinite.
inline bool isPositive(double value) {
  return value > 0.0 && value <= std::numeric_limits<double>::max();
}
inline bool isNotNegative(double value) {
  return value >= 0.0 && value <= std::numeric_limits<double>::max();
}

/// Edit distance: number of characters to insert, delete or replace to turn one word into the
/// other.
inline std::size_t editDistance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// Returns the known name with the smallest edit distance to `name`; empty if no distance is below
/// `limit`.
template <class Names>
std::string nearestName(const std::string& name, const Names& known, std::size_t limit) {
  std::string nearest;
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance >= limit) continue;
    limit = distance;
    nearest = candidate;
  }
  return nearest;
}

/// Collects the problems of one block, each as "block/key must <rule>, got <value>".
class OptionChecks {
 public:
  explicit OptionChecks(std::string block) : block_(std::move(block)) {}

  /// @param ok  condition; write it so that NaN makes it false
  template <class Value>
  void require(bool ok, const std::string& key, const std::string& rule, const Value& value) {
    if (!ok) problems_.push_back(textOf(block_, '/', key, " must ", rule, ", got ", value));
  }

  template <class Value>
  void requireWithin(const std::string& key, Value value, Value lowest, Value highest) {
    require(value >= lowest && value <= highest, key,
            textOf("lie in [", lowest, ", ", highest, "]"), value);
  }
  void requireAtLeast(const std::string& key, int value, int lowest) {
    require(value >= lowest, key, "be >= " + std::to_string(lowest), value);
  }
  void requirePositive(const std::string& key, double value) {
    require(isPositive(value), key, "be > 0 and finite", value);
  }
  /// Requires a valid time limit [s]. The upper bound of one day lies far below the 68 years at
  /// which roscpp's durations overflow.
  void requireTimeLimit(const std::string& key, double value) {
    require(value > 0.0 && value <= 86400.0, key, "lie in (0, 86400]", value);
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

/// Returns `options` unchanged. Use it in an initialiser list, so that the check comes before the
/// first use of the values.
/// @throws std::invalid_argument with all of its problems, one per line
template <class Options>
const Options& checked(const Options& options) {
  std::string problems;
  for (const std::string& problem : options.problems()) problems += "\n- " + problem;
  if (problems.empty()) return options;
  throw std::invalid_argument("invalid options:" + problems);
}

}  // namespace ddm
