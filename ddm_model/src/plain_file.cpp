// Files that are read and written as a whole.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/plain_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

std::string reason() { return errno == 0 ? "unknown reason" : std::strerror(errno); }

/// @return the kind of what is at the path, links followed; 0 if there is nothing
mode_t kindOf(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_mode & S_IFMT : 0;
}

[[noreturn]] void cannot(const std::string& what, const std::string& path) {
  throw std::runtime_error("cannot " + what + " " + path + ": " + reason());
}

}  // namespace

void requirePlainFile(const std::string& path) {
  errno = 0;
  const mode_t kind = kindOf(path);
  if (kind == 0) cannot("read", path);
  if (kind == S_IFDIR) {
    errno = EISDIR;
    cannot("read", path);
  }
  if (kind != S_IFREG) throw std::runtime_error("cannot read " + path + ": it is no plain file");
}

std::string readFile(const std::string& path) {
  requirePlainFile(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) cannot("read", path);
  std::ostringstream bytes;
  if (file.peek() != std::ifstream::traits_type::eof()) bytes << file.rdbuf();
  if (file.bad() || !bytes) cannot("read", path);
  return bytes.str();
}

void writeFileAtomically(const std::string& path, const std::string& bytes) {
  const mode_t kind = kindOf(path);
  if (kind != 0 && kind != S_IFREG) {
    throw std::runtime_error("cannot write " + path + ": it is no plain file");
  }
  const std::string unfinished = path + ".unfinished";
  ::unlink(unfinished.c_str());  // of a program that was killed
  const int file =
      ::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (file < 0) cannot("write", unfinished);
  size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(file, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const std::string why = reason();
      ::close(file);
      ::unlink(unfinished.c_str());
      throw std::runtime_error("cannot write " + unfinished + ": " + why);
    }
    written += static_cast<size_t>(count);
  }
  const bool stored = ::fsync(file) == 0;
  const bool closed = ::close(file) == 0;
  if (!stored || !closed || ::rename(unfinished.c_str(), path.c_str()) != 0) {
    const std::string why = reason();
    ::unlink(unfinished.c_str());
    throw std::runtime_error("cannot write " + path + ": " + why);
  }
}

}  // namespace ddm
