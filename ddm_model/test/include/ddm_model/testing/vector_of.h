// Short vectors, written out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <initializer_list>

namespace ddm {
namespace testing {

/// A vector of dynamic size from the start: converting one of fixed size, GCC 12 with AVX-512 warns
/// of an access out of bounds where there is none.
inline Eigen::VectorXd vectorOf(std::initializer_list<double> entries) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(entries.size()));
  std::copy(entries.begin(), entries.end(), out.data());
  return out;
}

}  // namespace testing
}  // namespace ddm
