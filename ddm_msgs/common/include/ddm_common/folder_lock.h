// A lock that gives one process exclusive use of a folder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// While this object exists, no other process can lock the folder, on any machine that shares it.
///
/// The lock is the file FOLDER/.lock, which names its owner. Kernel locks such as flock() are
/// missing on some cluster file systems or work within one machine only. All file systems can
/// create a file exclusively and rename a file:
///
///   1. A process that requests the lock creates .lock.new exclusively, with its own name.
///   2. If there is no .lock, or its owner has ended, .lock.new is renamed to .lock. Otherwise
///      .lock.new is deleted.
///   3. The owner deletes .lock at its end.
///
/// Only the creator of .lock.new replaces .lock, and only its owner deletes .lock. In step 2, .lock
/// therefore cannot become the lock of a living process. SIGINT, SIGTERM and SIGHUP also delete
/// .lock, unless the program handles these signals. The lock of a killed process remains. If the
/// killed process ran on this machine, the next process replaces the lock. If the killed process
/// ran on another machine, this machine cannot find out that the process has ended, and the lock
/// remains.
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
  std::string owner_;  // content of .lock
};

}  // namespace ddm
