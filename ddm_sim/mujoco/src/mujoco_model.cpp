// Implements MujocoModel: a model file (MJCF or URDF) that MuJoCo has compiled.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_model.h"

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <utility>

#include "model_files.h"
#include "xml_text.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

/// Path of an existing regular file.
/// @throws std::invalid_argument if the file does not exist, with the names of the model files in
///         its folder
std::string pathOf(const std::string& uri, const FindPackage& find_package) {
  const std::string path = resolved(uri, find_package);
  std::error_code none;
  if (fs::is_regular_file(path, none)) return path;
  if (fs::is_directory(path, none)) refuseModel(path, " is a folder: name the model file in it");
  if (fs::exists(path, none))
    refuseModel(path, " is a pipe or device: write the model into a file");
  if (fs::is_symlink(path, none)) {
    refuseModel(path, " is a link to ", fs::read_symlink(path, none).string(),
                ", where there is no file: correct the link");
  }
  std::vector<std::string> there;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::absolute(path).parent_path(), none)) {
    const fs::path& name = entry.path().filename();
    const bool model = name.extension() == ".xml" || name.extension() == ".urdf";
    if (model && entry.is_regular_file(none)) there.push_back(name.string());
  }
  std::sort(there.begin(), there.end());
  refuseModel("there is no file ", path, ": ",
              suggestion(fs::path(path).filename().string(), there));
}

/// Stops drawing the collision shapes (group 0) of links that also have visual shapes (group 1),
/// because collision shapes would hide the visual ones.
void hideCollisionShapes(mjModel* model) {
  constexpr int kNotDrawn = 3;  // Renderer draws the groups 0, 1 and 2
  std::set<int> seen;           // links with visual shapes
  for (int i = 0; i < model->ngeom; ++i) {
    if (model->geom_group[i] == 1) seen.insert(model->geom_bodyid[i]);
  }
  for (int i = 0; i < model->ngeom; ++i) {
    const bool hides = model->geom_group[i] == 0 && seen.count(model->geom_bodyid[i]) > 0;
    if (hides) model->geom_group[i] = kNotDrawn;
  }
}

bool isLit(const mjModel& model) {
  const auto& head = model.vis.headlight;
  const auto shines = [](float value) { return value > 0.0F; };
  return std::any_of(model.light_active, model.light_active + model.nlight,
                     [](mjtByte active) { return active != 0; }) ||
         (head.active != 0 && (std::any_of(head.ambient, head.ambient + 3, shines) ||
                               std::any_of(head.diffuse, head.diffuse + 3, shines)));
}

void light(mjModel* model) {
  model->vis.headlight.active = 1;
  std::fill_n(model->vis.headlight.ambient, 3, 0.4F);
  std::fill_n(model->vis.headlight.diffuse, 3, 0.6F);
  std::fill_n(model->vis.headlight.specular, 3, 0.1F);
}

/// A copy of `base` with its own arrays for equality constraints. All other arrays are those of
/// `base`.
struct CoupledModel {
  std::shared_ptr<const mjModel> base;
  mjModel model;
  std::vector<int> types, followers, leaders, names;
  std::vector<mjtByte> active;
  std::vector<mjtNum> solref, solimp, data;
};

std::shared_ptr<const mjModel> coupled(std::shared_ptr<const mjModel> base,
                                       const std::vector<Coupling>& couplings) {
  const std::size_t n = couplings.size();
  if (n == 0) return base;
  const auto own = std::make_shared<CoupledModel>();
  own->base = std::move(base);
  mjModel& m = own->model = *own->base;
  own->types.assign(n, mjEQ_JOINT);
  own->names.assign(n, 0);
  own->active.assign(n, 1);
  own->solref.resize(n * mjNREF);
  own->solimp.resize(n * mjNIMP);
  own->data.resize(n * mjNEQDATA);
  for (std::size_t i = 0; i < n; ++i) {
    own->followers.push_back(mj_name2id(&m, mjOBJ_JOINT, couplings[i].follower.c_str()));
    own->leaders.push_back(mj_name2id(&m, mjOBJ_JOINT, couplings[i].leader.c_str()));
    mj_defaultSolRefImp(&own->solref[i * mjNREF], &own->solimp[i * mjNIMP]);
    own->data[i * mjNEQDATA] = couplings[i].offset;
    own->data[i * mjNEQDATA + 1] = couplings[i].multiplier;
  }
  m.neq = static_cast<int>(n);  // a URDF has no other constraints
  m.nemax += m.neq;
  m.njmax += m.neq;
  m.nstack += 10 * (m.njmax + m.nv) * m.neq;
  m.eq_type = own->types.data();
  m.eq_obj1id = own->followers.data();
  m.eq_obj2id = own->leaders.data();
  m.name_eqadr = own->names.data();
  m.eq_active = own->active.data();
  m.eq_solref = own->solref.data();
  m.eq_solimp = own->solimp.data();
  m.eq_data = own->data.data();
  return {own, &m};
}

/// Adds settings that a URDF has no words for. Contacts are disabled, because neighbouring links
/// overlap in most URDF files. A light is added, because URDF has no lights.
std::shared_ptr<const mjModel> completedUrdf(ModelPointer model, const Urdf& urdf) {
  if (!urdf.contacts) model->opt.disableflags |= mjDSBL_CONTACT;
  hideCollisionShapes(model.get());
  light(model.get());
  return coupled(std::move(model), urdf.couplings);
}

/// Remedy if the root element of a file is not that of a model.
std::string hintForRoot(const std::string& root) {
  if (root == "sdf") return ": take the URDF or xacro that it was made from, or convert it to URDF";
  if (root == "collada") return ": this is a mesh; name the URDF or MJCF file that uses it";
  if (root != "mujocoinclude") return "";
  return ": this is a part of a model; name the MJCF file that includes it";
}

/// Error message in one line. The paths of mesh files replace the names that MuJoCo got.
std::string readable(std::string error, const ModelText& text) {
  for (const auto& mesh : text.meshes) {
    const fs::path beside = fs::absolute(text.path).parent_path() / mesh.first;
    boost::replace_all(error, beside.string(), mesh.second);
    boost::replace_all(error, mesh.first, mesh.second);
    boost::replace_all(error, "name = " + fs::path(mesh.first).stem().string() + ",",
                       "name = " + mesh.second + ",");
  }
  boost::trim(error);
  boost::replace_all(error, "\n", " ");
  return error;
}

}  // namespace

MujocoModel::MujocoModel(const std::string& uri, const FindPackage& find_package) : uri_(uri) {
  if (uri.empty()) {
    refuseModel(
        "plant/model must name a model file (MJCF or URDF), got nothing: for example "
        "package://PACKAGE/robot.urdf");
  }
  ModelText given;
  ModelFiles files;
  try {
    const std::string path = pathOf(uri, find_package);
    const std::string text = readModelFile(path);
    const std::string root =
        boost::to_lower_copy(std::string(parseXml(text)->RootElement()->Value()));
    if (root == "robot") {
      const Urdf urdf = readUrdf(text, path, find_package);
      given = urdf.model;
      urdf_ = urdf.facts;
      files = filesOf(given, find_package);
      files.missing.clear();  // readUrdf() has checked the meshes; MuJoCo ignores all other names
      model_ = completedUrdf(loadModel(given), urdf);
    } else if (root == "mujoco") {
      given = readMjcf(text, path, find_package);
      files = filesOf(given, find_package);
      ModelPointer model = loadModel(given);
      if (!isLit(*model)) light(model.get());
      model_ = std::move(model);
    } else {
      refuseModel("its outermost element must be <mujoco> (MJCF) or <robot> (URDF), got <", root,
                  ">", hintForRoot(root));
    }
  } catch (const std::exception& e) {
    const std::string hint = hintFor(e.what());
    refuseModel("plant/model must be a model that MuJoCo can read, got ", uri, ": ",
                readable(e.what(), given),
                files.missing.empty()
                    ? ""
                    : "; it names files that are not there: " + files.missing +
                          " (all paths count from the folder of the model file, also "
                          "those in included files)",
                hint.empty() ? "" : "; ", hint);
  }
  digest_ = files.digest;
}

int MujocoModel::id(mjtObj type, const std::string& name, const std::string& key) const {
  const int id = mj_name2id(model_.get(), type, name.c_str());
  if (id >= 0) return id;
  const std::vector<std::string> all = names(type);  // includes the names that name() makes up
  const auto found = std::find(all.begin(), all.end(), name);
  if (found != all.end()) return static_cast<int>(found - all.begin());
  refuseModel(key, " must name a ", mju_type2Str(type), " of ", uri_, ", got ", name, ": ",
              suggestion(name, all));
}

Place MujocoModel::place(const std::string& name, const std::string& key) const {
  for (const mjtObj type : {mjOBJ_SITE, mjOBJ_BODY}) {
    const int id = mj_name2id(model_.get(), type, name.c_str());
    if (id >= 0) return {type, id};
  }
  if (urdf_.fixed.count(name) > 0) {
    std::string parent = name;
    while (urdf_.fixed.count(parent) > 0) parent = urdf_.fixed.at(parent);
    const bool moves = mj_name2id(model_.get(), mjOBJ_BODY, parent.c_str()) > 0;
    refuseModel(
        key, " must name a link of ", uri_, " that a joint moves, got ", name,
        ", which is behind a fixed joint: links behind fixed joints are merged into their parent; ",
        moves ? "name that one, " + parent + ", or " : "this one does not move; ",
        "keep them apart by <mujoco><compiler fusestatic=\"false\"/></mujoco> in the URDF");
  }
  std::vector<std::string> known = names(mjOBJ_SITE);
  for (const std::string& body : names(mjOBJ_BODY)) known.push_back(body);
  refuseModel(key, " must name a site or body (link) of ", uri_, ", got ", name, ": ",
              suggestion(name, known));
}

std::string MujocoModel::name(mjtObj type, int id) const {
  const char* const name = mj_id2name(model_.get(), type, id);
  return name != nullptr && *name != '\0'
             ? name
             : mju_type2Str(type) + std::string("_") + std::to_string(id);
}

std::vector<std::string> MujocoModel::names(mjtObj type) const {
  std::vector<std::string> out;
  const int count = type == mjOBJ_JOINT  ? model_->njnt
                    : type == mjOBJ_SITE ? model_->nsite
                    : type == mjOBJ_BODY ? model_->nbody
                                         : model_->ncam;
  for (int i = 0; i < count; ++i) out.push_back(name(type, i));
  return out;
}

std::optional<double> MujocoModel::effortLimit(const std::string& joint) const {
  const auto found = urdf_.efforts.find(joint);
  return found == urdf_.efforts.end() ? std::nullopt : std::make_optional(found->second);
}

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  if (known.empty()) return "there is none";
  constexpr std::size_t kMost = 10;
  const std::vector<std::string> first(
      known.begin(), known.begin() + static_cast<std::ptrdiff_t>(std::min(known.size(), kMost)));
  std::string all = boost::algorithm::join(first, ", ");
  if (known.size() > kMost) all += textOf(" and ", known.size() - kMost, " more");
  const std::string near = nearestName(name, known, std::max<std::size_t>(3, name.size() / 3 + 1));
  return (near.empty() ? "there are " : "did you mean " + near + "? There are ") + all;
}

}  // namespace ddm
