// A folder that at most one process holds.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// Holds an existing folder until it goes, or the process ends, however it ends. The lock is on the
/// folder itself and leaves no file in it.
class FolderLock {
 public:
  /// @throws std::runtime_error if the folder cannot be opened, or another process holds it
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace ddm
