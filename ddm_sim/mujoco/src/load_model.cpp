// Compiles a model, after a separate process has tried it.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_files.h"

// mjxmacro.h lists the names and sizes of all arrays of a model.
#include <fcntl.h>
#include <mujoco/mjxmacro.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kStlHeader = 84;  // header and number of triangles [bytes]
constexpr std::size_t kStlTriangle = 50;

template <class Value>
void append(std::string* bytes, Value value) {
  char raw[sizeof(value)];
  std::memcpy(raw, &value, sizeof(value));
  bytes->append(raw, sizeof(value));
}

/// Size that a binary STL file must have, from the number of triangles in its header [bytes].
std::size_t sizeOfStl(const std::string& bytes) {
  std::uint32_t triangles = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&triangles, bytes.data() + 80, sizeof(triangles));
  return kStlHeader + kStlTriangle * std::size_t{triangles};
}

/// Whether an STL file is in ASCII format, which MuJoCo cannot read: "solid" and "facet" in small or
/// capital letters. Some binary files begin with "solid" too; the size of the file then decides.
bool isAsciiStl(const std::string& bytes) {
  const std::size_t begin = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  return boost::istarts_with(bytes.c_str() + begin, "solid") && boost::icontains(bytes, "facet") &&
         bytes.size() != sizeOfStl(bytes);
}

std::string binaryStl(const std::string& ascii) {
  std::istringstream in(ascii);
  std::vector<float> corners;
  std::string word;
  while (in >> word) {
    if (!boost::iequals(word, "vertex")) continue;
    float x = 0, y = 0, z = 0;
    if (!(in >> x >> y >> z)) break;
    corners.insert(corners.end(), {x, y, z});
  }
  const auto triangles = static_cast<std::uint32_t>(corners.size() / 9);
  std::string binary(80, '\0');
  append(&binary, triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    for (int k = 0; k < 3; ++k) append(&binary, 0.0F);  // MuJoCo computes the normal itself
    for (int k = 0; k < 9; ++k) append(&binary, corners[9 * std::size_t{i} + k]);
    append(&binary, std::uint16_t{0});
  }
  return binary;
}

void add(const std::string& name, const std::string& bytes, mjVFS* files) {
  const int index = files->nfile;
  if (bytes.empty()) refuseModel(name, " is empty");
  if (mj_makeEmptyFileVFS(files, name.c_str(), static_cast<int>(bytes.size())) != 0) {
    refuseModel("it names more files than MuJoCo takes, ", mjMAXVFS - 2);
  }
  std::memcpy(files->filedata[index], bytes.data(), bytes.size());
}

template <class Value>
void requireFinite(const char* name, const Value* values, int count) {
  if constexpr (std::is_floating_point_v<Value>) {
    if (std::all_of(values, values + count, [](Value x) { return std::isfinite(x); })) return;
    refuseModel("the compiled model has numbers that are not finite in ", name,
                ": look for nan, inf and very large numbers in the file");
  }
}

ModelPointer compile(const ModelText& model) {
  // Files in memory. MuJoCo finds them by their name without a folder. The structure has 2 MB, too
  // much for the stack.
  const std::unique_ptr<mjVFS, void (*)(mjVFS*)> files(new mjVFS, [](mjVFS* vfs) {
    mj_deleteVFS(vfs);
    delete vfs;
  });
  mj_defaultVFS(files.get());
  for (const auto& mesh : model.meshes) {
    const std::string bytes = readModelFile(mesh.second);
    const bool ascii = isAsciiStl(bytes);
    const bool binary = !ascii && fs::path(mesh.first).extension() == ".stl";
    if (binary && !bytes.empty() && bytes.size() != sizeOfStl(bytes)) {
      refuseModel(mesh.second, " has ", bytes.size(), " bytes and must have ", sizeOfStl(bytes),
                  " for the triangles that it counts: fetch or export it again");
    }
    add(mesh.first, ascii ? binaryStl(bytes) : bytes, files.get());
  }
  // No included file has this name. With the name of an included file, MuJoCo would read the text
  // in memory in its place.
  const std::string path =
      (fs::absolute(model.path).parent_path() / "model text.in memory").string();
  add(path, model.text, files.get());
  char error[1000] = "";
  mjModel* const compiled = mj_loadXML(path.c_str(), files.get(), error, sizeof(error));
  if (compiled == nullptr) throw std::invalid_argument(error);
  return {compiled, mj_deleteModel};
}

/// Compiles a model, simulates a few physics steps and updates the scene, in this process.
void tryHere(const ModelText& text) {
  const auto model = compile(text);
  const mjModel& m = *model;
  {
    MJMODEL_POINTERS_PREAMBLE(model)
#define X(type, name, rows, columns) requireFinite(#name, m.name, m.rows*(columns));
    MJMODEL_POINTERS
#undef X
  }
  const DataPointer data = makeData(m);
  for (int frame = 0; frame < 3; ++frame) mj_step(&m, data.get());
  mj_resetData(&m, data.get());
  mj_forward(&m, data.get());
  mjvScene scene;
  mjvOption all;
  mjvCamera camera;
  mjv_defaultScene(&scene);
  mjv_defaultOption(&all);
  mjv_defaultCamera(&camera);
  mjv_makeScene(&m, &scene, m.ngeom + 1000);
  mjv_updateScene(&m, data.get(), &all, nullptr, &camera, mjCAT_ALL, &scene);
  mjv_freeScene(&scene);
}

void limit(int resource, rlim_t value) {
  const rlimit both = {value, value};
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// Size of this process's address space [bytes].
rlim_t addressSpace() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// Body of the child process: writes "ok" or the reason of a failure to the pipe `told`, and exits
/// without running destructors.
[[noreturn]] void tryAndTell(const ModelText& model, int told) {
  // In addition to the present size of the process [bytes]
  constexpr rlim_t kMemory = rlim_t{4} << 30;
  constexpr rlim_t kComputing = 60;  // limit of processor time [s]
  // Limit of real time, for a busy machine or a file that never ends [s]
  constexpr unsigned int kWaiting = 300;
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

/// Runs tryHere() in a child process.
void tryInOwnProcess(const ModelText& model) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error(textOf("a model cannot be tried, pipe: ", std::strerror(errno)));
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
    throw std::runtime_error(textOf("a model cannot be tried, fork: ", std::strerror(errno)));
  }
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (said == "ok") return;
  if (!said.empty()) refuseModel(said);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL) {
    refuseModel("MuJoCo ", mj_versionString(),
                " did not finish reading it in time: make its meshes and textures smaller");
  }
  refuseModel("MuJoCo ", mj_versionString(), " crashes on it (",
              signal == 0 ? "it ends the process" : strsignal(signal),
              "): look for indices that do not exist, damaged meshes, and empty elements");
}

}  // namespace

std::string readModelFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in || in.bad()) refuseModel(path, " cannot be read");
  return bytes;
}

ModelPointer loadModel(const ModelText& model) {
  // Otherwise MuJoCo would wait for a key, exit, or write MUJOCO_LOG.TXT into the working folder.
  mju_user_error = [](const char* text) {
    throw std::runtime_error(std::string("MuJoCo: ") + text);
  };
  // mjData::warning counts warnings, see MujocoPhysics::requireStable().
  mju_user_warning = [](const char* /*text*/) {};
  tryInOwnProcess(model);
  return compile(model);
}

DataPointer makeData(const mjModel& model) {
  try {
    DataPointer data(mj_makeData(&model), mj_deleteData);
    if (data) return data;
  } catch (const std::runtime_error&) {
    // The error is thrown below.
  }
  refuseModel("there is not enough memory for its workspace of ", model.nstack / 131072,
              " MB: give it a smaller <size nstack, njmax, nconmax>");
}

}  // namespace ddm
