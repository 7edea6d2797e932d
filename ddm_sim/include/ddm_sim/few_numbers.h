// Numbers in a message to a person.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <sstream>
#include <string>

namespace ddm {

/// "[1 2 3]", of many the first ten: a million of them, sent by mistake, must not fill the logs.
inline std::string fewNumbers(const Eigen::VectorXd& numbers) {
  constexpr Eigen::Index kFew = 10;
  std::ostringstream text;
  text << "[" << numbers.head(std::min(numbers.size(), kFew)).transpose();
  if (numbers.size() > kFew) text << " ..., " << numbers.size() << " in all";
  text << "]";
  return text.str();
}

}  // namespace ddm
