// A lock that gives one process exclusive use of a folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace ddm {
namespace {

// Time limit for step 1. A process takes milliseconds from step 1 to step 2.
constexpr std::chrono::seconds kOpeningLimit(10);

[[noreturn]] void cannotLock(const std::string& folder, int error) {
  throw std::runtime_error("cannot lock the folder " + folder + ": " + std::strerror(error));
}

std::string hostName() {
  std::array<char, HOST_NAME_MAX + 1> host{};
  ::gethostname(host.data(), host.size() - 1);
  return host.data();
}

std::string firstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// Step 1: creates .lock.new and locks it by flock().
/// @return the file descriptor
int createNew(const std::string& folder, const std::string& path, const std::string& text) {
  const auto limit = std::chrono::steady_clock::now() + kOpeningLimit;
  int file = -1;
  while ((file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) < 0) {
    if (errno != EEXIST) cannotLock(folder, errno);
    if (std::chrono::steady_clock::now() > limit) {
      throw std::runtime_error("another process has been opening the folder " + folder + " for " +
                               std::to_string(kOpeningLimit.count()) + " s: if none is, delete " +
                               path);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ::flock(file, LOCK_EX | LOCK_NB);  // fails on file systems without locks, see hasEnded()
  const ssize_t count = ::write(file, text.data(), text.size());
  int error = count == static_cast<ssize_t>(text.size()) ? 0 : count < 0 ? errno : ENOSPC;
  if (error == 0 && ::fsync(file) != 0) error = errno;
  if (error == 0) return file;
  ::close(file);
  ::unlink(path.c_str());
  cannotLock(folder, error);
}

/// Whether the owner of a lock has certainly ended. The kernel releases the flock() of a process
/// that ends. A file system may have no locks, or locks that work within one machine only.
/// @param file  descriptor of .lock
bool hasEnded(int file, const std::string& owner) {
  const bool is_free = ::flock(file, LOCK_SH | LOCK_NB) == 0;
  return is_free && owner.substr(0, owner.find(' ')) == hostName();
}

/// Step 2: refuses the folder if .lock exists, unless its owner has ended.
void requireNoOwner(const std::string& folder, const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 && errno == ENOENT) return;
  if (file < 0) cannotLock(folder, errno);
  const std::string owner = firstLine(path);
  const bool has_ended = hasEnded(file, owner);
  ::close(file);
  if (has_ended) return;
  const std::size_t blank = owner.find(' ');
  const bool named = blank != std::string::npos;
  throw std::runtime_error("another process is running in the folder " + folder + ": process " +
                           (named ? owner.substr(blank + 1) : "?") + " on " +
                           (named ? owner.substr(0, blank) : "?") +
                           ". Wait for it, or use another folder. If you are sure that this "
                           "process has ended, delete " +
                           path);
}

/// Blocks signals, because a signal between the steps would leave .lock.new behind.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

/// File that a signal deletes before it ends the process. Null: none.
std::atomic<const char*> file_of_process{nullptr};
std::atomic<pid_t> process{0};  // process that owns the file; a child after fork() does not

void onSignal(int number) {
  const char* const path = file_of_process;
  if (path != nullptr && process == ::getpid()) ::unlink(path);
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void deleteAtSignal(const char* path) {
  process = ::getpid();
  file_of_process = path;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (::sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_DFL) {
      std::signal(number, onSignal);
    }
  }
}

}  // namespace

FolderLock::FolderLock(const std::string& folder)
    : owner_(hostName() + " " + std::to_string(::getpid())) {
  std::error_code error;
  path_ = (std::filesystem::canonical(folder, error) / ".lock").string();
  if (error) cannotLock(folder, error.value());
  const std::string created = path_ + ".new";
  const BlockedSignals blocked;
  file_ = createNew(folder, created, owner_ + "\n");
  try {
    requireNoOwner(folder, path_);
    if (::rename(created.c_str(), path_.c_str()) != 0) cannotLock(folder, errno);
  } catch (...) {
    ::unlink(created.c_str());
    ::close(file_);
    throw;
  }
  deleteAtSignal(path_.c_str());
}

FolderLock::~FolderLock() {
  const char* ours = path_.c_str();
  file_of_process.compare_exchange_strong(ours, nullptr);
  // A user may have deleted or replaced the lock.
  if (firstLine(path_) == owner_) ::unlink(path_.c_str());
  ::close(file_);
}

}  // namespace ddm
