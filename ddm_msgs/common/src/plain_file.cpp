// Reads and writes whole files, and expands paths in a home folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/plain_file.h"

#include <fcntl.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace ddm {
namespace {

namespace fs = std::filesystem;

std::string reason() { return errno == 0 ? "unknown reason" : std::strerror(errno); }

[[noreturn]] void cannot(const std::string& what, const std::string& path) {
  throw std::runtime_error("cannot " + what + " " + path + ": " + reason());
}

/// Opens a new file next to `path`, under a name that no other process or thread uses. Unlike
/// mkstemp(), the umask determines the permissions.
/// @return the file descriptor
/// @throws std::runtime_error if that fails, or if `path` exists and is not a regular file
int openUnfinished(const std::string& path, std::string* unfinished) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) {
    throw std::runtime_error("cannot write " + path + ": it is not a regular file");
  }
  std::random_device random;
  int file = -1;
  do {
    std::ostringstream name;
    name << path << ".unfinished." << std::hex << random() << random();
    *unfinished = name.str();
    file = ::open(unfinished->c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  } while (file < 0 && errno == EEXIST);
  if (file < 0) cannot("write", path);
  return file;
}

/// @return false, with errno set, if not all bytes were written
bool writeAll(int file, const std::string& bytes) {
  size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(file, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) written += static_cast<size_t>(count);
  }
  return true;
}

/// Waits until the content of a file, or the names in a folder, are on the disk.
/// @param flags  flags for open()
/// @return false, with errno set, on failure
bool store(const std::string& path, int flags) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (file < 0) return false;
  const int error = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  errno = error;
  return error == 0;
}

/// Renames a file and waits until its new name is on the disk.
/// @return false, with errno set, on failure
bool renameAndStore(const std::string& from, const std::string& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) return false;
  const size_t slash = to.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : to.substr(0, slash + 1);
  // Some folders cannot be opened for reading, and some file systems cannot synchronise a folder.
  // The file has been renamed in both cases, so these errors are ignored.
  return store(folder, O_DIRECTORY) || errno == EACCES || errno == EINVAL;
}

}  // namespace

void requirePlainFile(const std::string& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return;
  if (fs::is_directory(path, error)) error = std::make_error_code(std::errc::is_a_directory);
  throw std::runtime_error("cannot read " + path + ": " +
                           (error ? error.message() : "it is not a regular file"));
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

void requireWritable(const std::string& path) {
  std::string unfinished;
  ::close(openUnfinished(path, &unfinished));
  ::unlink(unfinished.c_str());
}

void writeFileAtomically(const std::string& path, const std::string& bytes) {
  std::string unfinished;
  const int file = openUnfinished(path, &unfinished);
  int error = writeAll(file, bytes) && ::fsync(file) == 0 ? 0 : errno;
  if (::close(file) != 0 && error == 0) error = errno;
  if (error == 0 && !renameAndStore(unfinished, path)) error = errno;
  if (error == 0) return;
  ::unlink(unfinished.c_str());
  errno = error;
  cannot("write", path);
}

void removeUnfinished(const std::string& folder) {
  static const std::regex kUnfinished(".*\\.unfinished\\.[0-9a-f]+");
  std::error_code ignored;  // remaining files do no harm
  const auto options = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator entry(folder, options, ignored), end; entry != end;
       entry.increment(ignored)) {
    if (std::regex_match(entry->path().filename().string(), kUnfinished)) {
      fs::remove(entry->path(), ignored);
    }
  }
}

void renameDurably(const std::string& from, const std::string& to) {
  if (!store(from, /*flags=*/0)) cannot("store", from);
  if (!renameAndStore(from, to)) cannot("rename", from + " to " + to);
}

std::string expandHome(std::string word) {
  const std::size_t start = word.rfind("--", 0) == 0 ? word.find('=') + 1 : 0;  // npos + 1 is 0
  if (start >= word.size() || word[start] != '~') return word;
  const std::size_t end = std::min(word.find('/', start), word.size());
  const std::string name = word.substr(start + 1, end - start - 1);
  const char* home = name.empty() ? std::getenv("HOME") : nullptr;
  if (!name.empty()) {
    const passwd* const user = ::getpwnam(name.c_str());
    if (user != nullptr) home = user->pw_dir;
  }
  return home == nullptr ? word : word.replace(start, end - start, home);
}

}  // namespace ddm
