// Tries a model in a process of its own.
// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "load_model.h"

namespace ddm {
namespace {

/// A file in memory without a name.
class Scratch {
 public:
  explicit Scratch(const std::string& bytes) : file_(memfd_create("model", MFD_CLOEXEC)) {
    if (file_ < 0) throw std::runtime_error(std::string("memfd_create: ") + std::strerror(errno));
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t written = write(file_, bytes.data() + done, bytes.size() - done);
      if (written <= 0) throw std::runtime_error(std::string("write: ") + std::strerror(errno));
      done += static_cast<std::size_t>(written);
    }
    lseek(file_, 0, SEEK_SET);
  }
  ~Scratch() { close(file_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  int descriptor() const { return file_; }

  std::string bytes() const {
    std::string text(static_cast<std::size_t>(lseek(file_, 0, SEEK_END)), '\0');
    const ssize_t got = pread(file_, text.data(), text.size(), 0);
    text.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
    return text;
  }

 private:
  int file_;
};

/// The program try_model, which is installed in the folder ddm_sim beside this library.
std::string program() {
  Dl_info library;
  if (dladdr(reinterpret_cast<void*>(&tryInOwnProcess), &library) == 0) {
    throw std::runtime_error("the folder of libddm_mujoco.so is unknown");
  }
  return (std::filesystem::absolute(library.dli_fname).parent_path() / "ddm_sim" / "try_model")
      .string();
}

/// @return what waitpid() says of the process when it has ended
int run(std::vector<std::string> words, const Scratch& in, const Scratch& out) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, in.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, out.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int error = posix_spawn(&process, arguments[0], &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    throw std::runtime_error("the program " + words[0] +
                             ", which tries models, cannot be started (" + std::strerror(error) +
                             "): build or install the package ddm_sim");
  }
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

void tryInOwnProcess(const ModelText& model) {
  std::vector<std::string> words = {program(), model.path};
  for (const auto& mesh : model.meshes) {
    words.push_back(mesh.first);
    words.push_back(mesh.second);
  }
  const Scratch in(model.text);
  const Scratch out("");
  const int status = run(words, in, out);
  const std::string said = out.bytes();
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
