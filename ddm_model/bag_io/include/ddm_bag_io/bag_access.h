// Which bags a request may name: ROS 1 does not know who asks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Block `access`.
struct BagAccess {
  /// Folders, with all that is in them, and single bags. Relative ones: from the folder in which
  /// the node was started.
  std::vector<std::string> bags = {"."};

  /// Links are followed, also one whose target is still to be made.
  /// @throws std::runtime_error if the path is none of these and lies in none of them
  void require(const std::string& path) const;

  /// The same for a bag that is to be recorded: nobody's request may replace a file.
  /// @throws std::runtime_error also if the path does not end in .bag, or something is there
  void requireNew(const std::string& path) const;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("bags", bags);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

}  // namespace ddm
