// A lock that gives one process exclusive use of a folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/folder_lock.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

namespace ddm {
namespace {

using Owner = std::map<std::string, std::string>;

// Time limit for step 1. A process takes milliseconds from step 1 to step 2.
constexpr std::chrono::seconds kOpeningLimit(10);

std::string firstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// Start time of a process, in ticks since the start of the machine. The start time distinguishes
/// processes with the same process id.
/// @return "ended" for a zombie process; empty if the start time is not known
std::string startOf(const std::string& pid) {
  std::string stat = firstLine("/proc/" + pid + "/stat");
  const std::string::size_type end_of_name = stat.rfind(')');
  if (end_of_name == std::string::npos) return "";
  std::istringstream words(stat.substr(end_of_name + 1));
  const std::istream_iterator<std::string> first(words), end;
  const std::vector<std::string> fields(first, end);  // begins with field 3 of proc(5)
  if (fields.size() < 20) return "";
  return fields[0] == "Z" || fields[0] == "X" ? "ended" : fields[19];
}

std::string pidNamespace() {
  std::array<char, 64> name{};
  const ssize_t length = ::readlink("/proc/self/ns/pid", name.data(), name.size());
  return length > 0 ? std::string(name.data(), static_cast<size_t>(length)) : "";
}

Owner thisProcess() {
  std::array<char, HOST_NAME_MAX + 1> host{};
  ::gethostname(host.data(), host.size() - 1);
  const std::string pid = std::to_string(::getpid());
  const std::string boot = firstLine("/proc/sys/kernel/random/boot_id");
  const std::string machine = firstLine("/etc/machine-id");  // missing in many containers
  return {{"host", host.data()},   {"pid", pid},
          {"start", startOf(pid)}, {"machine", machine.empty() ? boot : machine},
          {"boot", boot},          {"namespace", pidNamespace()}};
}

std::string textOf(const Owner& owner) {
  std::string text;
  for (const auto& entry : owner) text += entry.first + ": " + entry.second + "\n";
  return text;
}

std::string readAll(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// @return empty if the text does not name a process
Owner parseOwner(const std::string& text) {
  Owner owner;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string::size_type colon = line.find(": ");
    if (colon != std::string::npos) owner[line.substr(0, colon)] = line.substr(colon + 2);
  }
  for (const char* key : {"host", "pid", "start", "machine", "boot", "namespace"}) {
    if (owner.count(key) == 0) return {};
  }
  const std::string& pid = owner["pid"];
  const bool number = !pid.empty() && pid.find_first_not_of("0123456789") == std::string::npos;
  return number && std::atol(pid.c_str()) > 0 ? owner : Owner();
}

bool isOnThisMachine(const Owner& owner, const Owner& self) {
  return owner.at("host") == self.at("host") && owner.at("machine") == self.at("machine");
}

/// Whether a process has certainly ended. A process in another container is not visible.
bool hasEnded(const Owner& owner, const Owner& self) {
  if (!isOnThisMachine(owner, self)) return false;
  if (owner.at("boot") != self.at("boot")) return true;
  if (owner.at("namespace") != self.at("namespace")) return false;
  const std::string& pid = owner.at("pid");
  const std::string start = startOf(pid);
  if (!start.empty() && !owner.at("start").empty()) return start != owner.at("start");
  return ::kill(static_cast<pid_t>(std::atol(pid.c_str())), 0) != 0 && errno == ESRCH;
}

[[noreturn]] void refuse(const std::string& folder, const std::string& file, const Owner& owner,
                         const Owner& self) {
  if (owner.empty()) {
    throw std::runtime_error("another process may be running in the folder " + folder +
                             ", but its lock does not name one: if none is, delete " + file);
  }
  const bool here = isOnThisMachine(owner, self) && owner.at("namespace") == self.at("namespace");
  throw std::runtime_error(
      "another process is running in the folder " + folder + ": process " + owner.at("pid") +
      " on " + (here ? "this machine, " : "") + owner.at("host") +
      ". Wait for it, or use another folder" +
      (here ? "" : ". If you are sure that this process has ended, delete " + file));
}

[[noreturn]] void cannotLock(const std::string& folder, int error) {
  throw std::runtime_error("cannot lock the folder " + folder + ": " + std::strerror(error));
}

/// Step 1: creates .lock.new.
void createNew(const std::string& folder, const std::string& path, const std::string& text) {
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
  const ssize_t count = ::write(file, text.data(), text.size());
  int error = count == static_cast<ssize_t>(text.size()) ? 0 : count < 0 ? errno : ENOSPC;
  if (error == 0 && ::fsync(file) != 0) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  if (error == 0) return;
  ::unlink(path.c_str());
  cannotLock(folder, error);
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

/// Files that a signal deletes before it ends the process.
std::array<std::atomic<const char*>, 8> files_of_process{};
std::atomic<pid_t> process{0};  // process that owns the files; a child after fork() does not

void onSignal(int number) {
  for (const auto& file : files_of_process) {
    const char* const path = file;
    if (path != nullptr && process == ::getpid()) ::unlink(path);
  }
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void deleteAtSignal(const char* path) {
  process = ::getpid();
  for (auto& file : files_of_process) {
    const char* none = nullptr;
    if (file.compare_exchange_strong(none, path)) break;
  }
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (::sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_DFL) {
      std::signal(number, onSignal);
    }
  }
}

void keepAtSignal(const char* path) {
  for (auto& file : files_of_process) {
    const char* ours = path;
    if (file.compare_exchange_strong(ours, nullptr)) return;
  }
}

}  // namespace

FolderLock::FolderLock(const std::string& folder) {
  char* const absolute = ::realpath(folder.c_str(), nullptr);
  if (absolute == nullptr) cannotLock(folder, errno);
  path_ = std::string(absolute) + "/.lock";
  std::free(absolute);
  const Owner self = thisProcess();
  owner_ = textOf(self);
  const std::string created = path_ + ".new";
  const BlockedSignals blocked;
  createNew(folder, created, owner_);
  try {
    if (::access(path_.c_str(), F_OK) == 0 || errno != ENOENT) {
      const Owner other = parseOwner(readAll(path_));
      if (other.empty() || !hasEnded(other, self)) refuse(folder, path_, other, self);
    }
    if (::rename(created.c_str(), path_.c_str()) != 0) cannotLock(folder, errno);
  } catch (...) {
    ::unlink(created.c_str());
    throw;
  }
  deleteAtSignal(path_.c_str());
}

FolderLock::~FolderLock() {
  keepAtSignal(path_.c_str());
  // A user may have deleted or replaced the lock.
  if (readAll(path_) == owner_) ::unlink(path_.c_str());
}

}  // namespace ddm
