// Compiles a model.
// SPDX-License-Identifier: BSD-3-Clause
#include "load_model.h"

// mjxmacro.h knows the names and sizes of all arrays of a model.
#include <mujoco/mjxmacro.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

void throwError(const char* text) { throw std::runtime_error(std::string("MuJoCo: ") + text); }

void ignoreWarning(const char* /*text*/) {}  // mjData::warning counts them, see requireStable()

constexpr std::size_t kStlHeader = 84;  // with the number of triangles [bytes]
constexpr std::size_t kStlTriangle = 50;

template <class Value>
void append(std::string* bytes, Value value) {
  char raw[sizeof(value)];
  std::memcpy(raw, &value, sizeof(value));
  bytes->append(raw, sizeof(value));
}

/// Of a binary file with the number of triangles that this one has [bytes].
std::size_t sizeOfStl(const std::string& bytes) {
  std::uint32_t triangles = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&triangles, bytes.data() + 80, sizeof(triangles));
  return kStlHeader + kStlTriangle * std::size_t{triangles};
}

/// MuJoCo reads binary STL alone. Some binary files begin as ASCII files do, so that the size
/// decides.
bool isAsciiStl(const std::string& bytes) {
  if (bytes.rfind("solid", 0) != 0 || bytes.find("facet") == std::string::npos) return false;
  return bytes.size() != sizeOfStl(bytes);
}

std::string binaryStl(const std::string& ascii) {
  std::istringstream in(ascii);
  in.imbue(std::locale::classic());
  std::vector<float> corners;
  std::string word;
  while (in >> word) {
    if (word != "vertex") continue;
    float x = 0, y = 0, z = 0;
    if (!(in >> x >> y >> z)) break;
    corners.insert(corners.end(), {x, y, z});
  }
  const auto triangles = static_cast<std::uint32_t>(corners.size() / 9);
  std::string binary(80, '\0');
  append(&binary, triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    for (int k = 0; k < 3; ++k) append(&binary, 0.0F);  // MuJoCo computes the normal
    for (int k = 0; k < 9; ++k) append(&binary, corners[9 * std::size_t{i} + k]);
    append(&binary, std::uint16_t{0});
  }
  return binary;
}

/// Files in memory, which MuJoCo finds by their name without a folder.
class MemoryFiles {
 public:
  MemoryFiles() : vfs_(new mjVFS) { mj_defaultVFS(vfs_.get()); }
  ~MemoryFiles() { mj_deleteVFS(vfs_.get()); }
  MemoryFiles(const MemoryFiles&) = delete;
  MemoryFiles& operator=(const MemoryFiles&) = delete;

  void add(const std::string& name, const std::string& bytes) {
    const int index = vfs_->nfile;
    if (bytes.empty()) throw std::invalid_argument(name + " is empty");
    if (mj_makeEmptyFileVFS(vfs_.get(), name.c_str(), static_cast<int>(bytes.size())) != 0) {
      throw std::invalid_argument("it names more files than MuJoCo takes, " +
                                  std::to_string(mjMAXVFS - 2));
    }
    std::memcpy(vfs_->filedata[index], bytes.data(), bytes.size());
  }

  const mjVFS* get() const { return vfs_.get(); }

 private:
  std::unique_ptr<mjVFS> vfs_;  // 2 MB, too much for a stack
};

template <class Value>
void requireFinite(const char* name, const Value* values, int count) {
  if constexpr (std::is_floating_point_v<Value>) {
    if (std::all_of(values, values + count, [](Value x) { return std::isfinite(x); })) return;
    throw std::invalid_argument(
        std::string("the compiled model has numbers that are not finite in ") + name +
        ": look for nan, inf and very large numbers in the file");
  }
}

}  // namespace

void installMujocoHandlers() {
  mju_user_error = throwError;
  mju_user_warning = ignoreWarning;
}

std::string readModelFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in || in.bad()) throw std::invalid_argument(path + " cannot be read");
  return bytes;
}

std::unique_ptr<mjModel, void (*)(mjModel*)> compile(const ModelText& model) {
  installMujocoHandlers();
  MemoryFiles files;
  for (const auto& mesh : model.meshes) {
    const std::string bytes = readModelFile(mesh.second);
    const bool ascii = isAsciiStl(bytes);
    const bool binary = !ascii && fs::path(mesh.first).extension() == ".stl";
    if (binary && !bytes.empty() && bytes.size() != sizeOfStl(bytes)) {
      throw std::invalid_argument(mesh.second + " has " + std::to_string(bytes.size()) +
                                  " bytes and must have " + std::to_string(sizeOfStl(bytes)) +
                                  " for the triangles that it counts: fetch or export it again");
    }
    files.add(mesh.first, ascii ? binaryStl(bytes) : bytes);
  }
  // A name that no included file has: MuJoCo would take the text in memory for that file.
  const std::string path =
      (fs::absolute(model.path).parent_path() / "model text.in memory").string();
  files.add(path, model.text);
  char error[1000] = "";
  mjModel* const compiled = mj_loadXML(path.c_str(), files.get(), error, sizeof(error));
  if (compiled == nullptr) throw std::invalid_argument(error);
  return {compiled, mj_deleteModel};
}

void tryHere(const ModelText& text) {
  const auto model = compile(text);
  const mjModel& m = *model;
  {
    MJMODEL_POINTERS_PREAMBLE(model)
#define X(type, name, rows, columns) requireFinite(#name, m.name, m.rows*(columns));
    MJMODEL_POINTERS
#undef X
  }
  std::unique_ptr<mjData, void (*)(mjData*)> data(nullptr, mj_deleteData);
  try {
    data.reset(mj_makeData(&m));
  } catch (const std::runtime_error&) {  // said below
  }
  if (!data) {
    throw std::invalid_argument("there is not enough memory for its workspace of " +
                                std::to_string(m.nstack / 131072) +
                                " MB: give it a smaller <size nstack, njmax, nconmax>");
  }
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

}  // namespace ddm
