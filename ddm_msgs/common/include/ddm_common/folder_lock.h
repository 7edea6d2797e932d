// A lock that gives one process exclusive use of a folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// While this object exists, no other process can lock the folder, on any machine that shares it.
///
/// The lock is the file FOLDER/.lock, which names its owner: "HOST PROCESS_ID". All file systems can
/// create a file exclusively and rename a file:
///
///   1. A process that requests the lock creates .lock.new exclusively, with its own name.
///   2. If there is no .lock, or its owner has ended, .lock.new is renamed to .lock. Otherwise
///      .lock.new is deleted.
///   3. The owner deletes .lock at its end.
///
/// Only the creator of .lock.new replaces .lock, and only its owner deletes .lock. In step 2, .lock
/// therefore cannot become the lock of a living process. SIGINT, SIGTERM and SIGHUP also delete the
/// .lock of the last object, unless the program handles these signals. The lock of a killed process
/// remains. flock() tells the next process on the same machine that the owner has ended, and this
/// process replaces the lock. Another machine cannot be sure, because flock() works within one
/// machine only on some cluster file systems. There, and if the file system does not have flock(),
/// the lock remains.
class FolderLock {
 public:
  /// @param folder  path of an existing folder
  /// @throws std::runtime_error with host and process id of the owner if another process has locked
  ///         the folder, or if the files cannot be written
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::string path_;   // path of .lock
  std::string owner_;  // first line of .lock
  int file_ = -1;      // descriptor of .lock, which holds the flock()
};

}  // namespace ddm
