// A model file, MJCF or URDF, as MuJoCo understands it.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_model.h"

#include <ddm_params/option_checks.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "model_files.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

void throwError(const char* text) { throw std::runtime_error(std::string("MuJoCo: ") + text); }

void ignoreWarning(const char* /*text*/) {}  // mjData::warning counts them, see requireStable()

/// @throws std::invalid_argument if there is no such file, naming those in its folder
std::string pathOf(const std::string& uri, const FindPackage& find_package) {
  const std::string path = withoutPackageUris(uri, find_package);
  if (fs::is_regular_file(path)) return path;
  std::vector<std::string> there;
  std::error_code none;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::absolute(path).parent_path(), none)) {
    const fs::path& name = entry.path().filename();
    if (name.extension() == ".xml" || name.extension() == ".urdf") there.push_back(name.string());
  }
  std::sort(there.begin(), there.end());
  throw std::invalid_argument("there is no file " + path + ": " +
                              suggestion(fs::path(path).filename().string(), there));
}

/// A file in memory, for MuJoCo's reader.
class MemoryFile {
 public:
  MemoryFile(const std::string& path, const std::string& text) : vfs_(new mjVFS) {
    mj_defaultVFS(vfs_.get());
    const int failed = mj_makeEmptyFileVFS(vfs_.get(), fs::path(path).filename().c_str(),
                                           static_cast<int>(text.size()));
    if (failed != 0) throw std::invalid_argument("it does not fit into memory");
    std::memcpy(vfs_->filedata[0], text.data(), text.size());
  }
  ~MemoryFile() { mj_deleteVFS(vfs_.get()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const mjVFS* get() const { return vfs_.get(); }

 private:
  std::unique_ptr<mjVFS> vfs_;  // 2 MB, too much for a stack
};

/// @throws std::invalid_argument with MuJoCo's reason
std::unique_ptr<mjModel, void (*)(mjModel*)> compile(const std::string& path, const mjVFS* files) {
  char error[1000] = "";
  mjModel* const model = mj_loadXML(path.c_str(), files, error, sizeof(error));
  if (model == nullptr) throw std::invalid_argument(error);
  return {model, mj_deleteModel};
}

/// Does not draw the collision shapes (group 0) of links that have visual ones (group 1): they lie on
/// these and would hide them.
void hideCollisionShapes(mjModel* model) {
  constexpr int kNotDrawn = 3;  // groups 0, 1 and 2 are drawn
  std::set<int> seen;           // links with visual shapes
  for (int i = 0; i < model->ngeom; ++i) {
    if (model->geom_group[i] == 1) seen.insert(model->geom_bodyid[i]);
  }
  for (int i = 0; i < model->ngeom; ++i) {
    const bool hides = model->geom_group[i] == 0 && seen.count(model->geom_bodyid[i]) > 0;
    if (hides) model->geom_group[i] = kNotDrawn;
  }
}

std::shared_ptr<const mjModel> compileUrdf(const std::string& path, const std::string& text,
                                           const FindPackage& find_package) {
  const MemoryFile file(path, withoutPackageUris(urdfForMujoco(text), find_package));
  auto model = compile(path, file.get());
  if (hasMujocoBlock(text)) return model;
  // What a URDF cannot say. Neighbouring links overlap in most of them, and all are in the dark.
  model->opt.disableflags |= mjDSBL_CONTACT;
  hideCollisionShapes(model.get());
  std::fill_n(model->vis.headlight.ambient, 3, 0.4F);
  std::fill_n(model->vis.headlight.diffuse, 3, 0.6F);
  std::fill_n(model->vis.headlight.specular, 3, 0.1F);
  return model;
}

int countOf(const mjModel& model, mjtObj type) {
  switch (type) {
    case mjOBJ_JOINT:
      return model.njnt;
    case mjOBJ_SITE:
      return model.nsite;
    case mjOBJ_BODY:
      return model.nbody;
    default:
      return 0;
  }
}

}  // namespace

void installMujocoHandlers() {
  mju_user_error = throwError;
  mju_user_warning = ignoreWarning;
}

MujocoModel::MujocoModel(const std::string& uri, const FindPackage& find_package) : uri_(uri) {
  installMujocoHandlers();
  if (uri.empty()) {
    throw std::invalid_argument(
        "plant/model must name a model file (MJCF or URDF), got nothing: for example "
        "package://PACKAGE/robot.urdf");
  }
  std::string text, missing;
  try {
    const std::string path = pathOf(uri, find_package);
    text = readModelFile(path);
    const ModelFiles files = filesOf(path, find_package);
    digest_ = files.digest;
    missing = files.missing;
    if (isUrdf(text)) {
      efforts_ = effortLimits(text);
      model_ = compileUrdf(path, text, find_package);
    } else {
      model_ = compile(path, nullptr);
    }
  } catch (const std::exception& e) {
    const std::string hint = hintFor(text, e.what());
    throw std::invalid_argument(
        "plant/model must be a model that MuJoCo can read, got " + uri + ": " + e.what() +
        (missing.empty() ? "" : "; it names files that are not there: " + missing) +
        (hint.empty() ? "" : "; " + hint));
  }
}

int MujocoModel::id(mjtObj type, const std::string& name, const std::string& key) const {
  const int id = mj_name2id(model_.get(), type, name.c_str());
  if (id >= 0) return id;
  throw std::invalid_argument(key + " must name a " + mju_type2Str(type) + " of " + uri_ +
                              ", got " + name + ": " + suggestion(name, names(type)));
}

Place MujocoModel::place(const std::string& name, const std::string& key) const {
  for (const mjtObj type : {mjOBJ_SITE, mjOBJ_BODY}) {
    const int id = mj_name2id(model_.get(), type, name.c_str());
    if (id >= 0) return {type, id};
  }
  std::vector<std::string> known = names(mjOBJ_SITE);
  for (const std::string& body : names(mjOBJ_BODY)) known.push_back(body);
  throw std::invalid_argument(key + " must name a site or body (link) of " + uri_ + ", got " +
                              name + ": " + suggestion(name, known));
}

std::string MujocoModel::name(mjtObj type, int id) const {
  const char* const name = mj_id2name(model_.get(), type, id);
  return name != nullptr && *name != '\0'
             ? name
             : mju_type2Str(type) + std::string("_") + std::to_string(id);
}

std::vector<std::string> MujocoModel::names(mjtObj type) const {
  std::vector<std::string> out;
  for (int i = 0; i < countOf(*model_, type); ++i) out.push_back(name(type, i));
  return out;
}

double MujocoModel::effortLimit(const std::string& joint) const {
  const auto found = efforts_.find(joint);
  return found == efforts_.end() ? 0.0 : found->second;
}

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  if (known.empty()) return "there is none";
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  const std::string near = nearestName(name, known, std::max<std::size_t>(3, name.size() / 3 + 1));
  return (near.empty() ? "there are " : "did you mean " + near + "? There are ") + all;
}

}  // namespace ddm
