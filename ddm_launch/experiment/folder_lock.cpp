// A folder that at most one process holds.
// SPDX-License-Identifier: BSD-3-Clause
#include "folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace ddm {

FolderLock::FolderLock(const std::string& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw std::runtime_error("cannot open the folder " + folder + ": " + std::strerror(errno));
  }
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(descriptor_);
  if (error == EWOULDBLOCK) {
    throw std::runtime_error("another experiment is running in the folder " + folder +
                             ": wait for it, or use another folder");
  }
  throw std::runtime_error("cannot lock the folder " + folder + ": " + std::strerror(error));
}

FolderLock::~FolderLock() { ::close(descriptor_); }

}  // namespace ddm
