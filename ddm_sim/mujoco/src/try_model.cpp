// Tries a model in a process of its own.
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>

#include "load_model.h"

namespace ddm {
namespace {

void limit(int resource, rlim_t value) {
  const rlimit both = {value, value};
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// Of this process now [bytes].
rlim_t addressSpace() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// What the child process does: writes `ok` or a reason, and ends without cleaning up.
[[noreturn]] void tryAndTell(const ModelText& model, int told) {
  constexpr rlim_t kMemory = rlim_t{4} << 30;  // more than this process has already [bytes]
  constexpr rlim_t kComputing = 60;            // [s]
  constexpr unsigned int kWaiting = 300;       // for a loaded machine or a file that never ends [s]
  std::signal(SIGINT, SIG_DFL);
  limit(RLIMIT_AS, addressSpace() + kMemory);
  limit(RLIMIT_CPU, kComputing);
  limit(RLIMIT_CORE, 0);
  alarm(kWaiting);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  std::string said = "ok";
  try {
    tryHere(model);
  } catch (const std::bad_alloc&) {
    said = "it needs more than 4 GB of memory: make its meshes, textures and sizes smaller";
  } catch (const std::exception& e) {
    said = e.what();
    if (said.empty()) said = "MuJoCo refuses it without a reason";
  }
  for (std::size_t done = 0; done < said.size();) {
    const ssize_t written = write(told, said.data() + done, said.size() - done);
    if (written <= 0) break;
    done += static_cast<std::size_t>(written);
  }
  _exit(0);
}

}  // namespace

void tryInOwnProcess(const ModelText& model) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error(std::string("a model cannot be tried, pipe: ") + std::strerror(errno));
  }
  const pid_t process = fork();
  if (process == 0) tryAndTell(model, ends[1]);
  close(ends[1]);
  std::string said;
  char part[4096];
  for (ssize_t size = 1; process > 0 && size != 0;) {
    size = read(ends[0], part, sizeof(part));
    if (size > 0) said.append(part, static_cast<std::size_t>(size));
    if (size < 0 && errno != EINTR) break;
  }
  close(ends[0]);
  if (process < 0) {
    throw std::runtime_error(std::string("a model cannot be tried, fork: ") + std::strerror(errno));
  }
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (said == "ok") return;
  if (!said.empty()) throw std::invalid_argument(said);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  const bool slow = signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL;
  throw std::invalid_argument(
      "MuJoCo " + std::string(mj_versionString()) +
      (slow ? " did not finish reading it within a minute: make its meshes and textures smaller"
            : " crashes on it (" +
                  std::string(signal == 0 ? "it ends the process" : strsignal(signal)) +
                  "): look for indices that do not exist, damaged meshes, and empty elements"));
}

}  // namespace ddm
