// A folder for one process at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// While this object lives, no other process gets the folder, on any machine that shares it.
///
/// The lock is the file FOLDER/.lock, which names its owner. Locks of the kernel, such as flock(),
/// are missing on some file systems of clusters, or hold on one machine only. All file systems can
/// create a file exclusively and rename it:
///
///   1. The process that wants the lock creates .lock.new exclusively, with its own name.
///   2. If there is no .lock, or its owner has ended, .lock.new is renamed to .lock. Otherwise
///      .lock.new is deleted.
///   3. The owner deletes .lock at its end.
///
/// Since only the creator of .lock.new replaces .lock, and since only its owner deletes it, .lock
/// cannot change in step 2 to that of a living process. SIGINT, SIGTERM and SIGHUP also delete it,
/// unless the program handles them. The lock of a process that was killed remains: if that process
/// ran on this machine, the next one replaces the lock; if not, nobody here can know that it has
/// ended.
class FolderLock {
 public:
  /// @param folder  must exist
  /// @throws std::runtime_error if another process has the folder, naming host and number of that
  ///         process, or if the files cannot be written
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::string path_;   // of .lock
  std::string owner_;  // what is in it
};

}  // namespace ddm
