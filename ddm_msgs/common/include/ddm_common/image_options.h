// Parameters of the images that nodes exchange. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Block `image`.
struct ImageOptions {
  int size = 51;  ///< width and height of all images [pixels], D = size^2

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("size", size);
  }
  /// Describes each invalid value and the rule that it breaks. Empty if all values are valid.
  std::vector<std::string> problems() const {
    if (size >= 4 && size <= 1024) return {};
    return {"image/size must lie in [4, 1024], got " + std::to_string(size)};
  }
};

}  // namespace ddm
