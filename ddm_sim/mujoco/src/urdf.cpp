// Checks a URDF file, and changes what MuJoCo would read in another way than the author meant.
// SPDX-License-Identifier: BSD-3-Clause
#include "urdf.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "model_files.h"
#include "urdf_checks.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using boost::algorithm::join;
using tinyxml2::XMLElement;

/// The file that an attribute names, as a path.
std::string fileOf(const XMLElement& element, const std::string& name, const fs::path& folder,
                   const FindPackage& find_package) {
  try {
    const std::string path = resolved(attribute(element, name.c_str()), find_package);
    return (folder / path).lexically_normal().string();
  } catch (const std::invalid_argument& e) {
    refuseElement(element, e.what());
  }
}

/// `meshdir` and `strippath` of a <mujoco> block, as MuJoCo applies them: by default it strips the
/// folder.
std::optional<fs::path> inMeshFolder(const XMLElement* compiler, const std::string& name) {
  if (compiler == nullptr || compiler->Attribute("meshdir") == nullptr) return std::nullopt;
  const bool keeps_folders = attribute(*compiler, "strippath") == "false";
  return fs::path(attribute(*compiler, "meshdir")) /
         (keeps_folders ? fs::path(name) : fs::path(name).filename());
}

/// Gives each file of a mesh a name of its own: MuJoCo tells meshes apart by the name without its
/// folder.
class MeshNames {
 public:
  MeshNames(const fs::path& folder, const FindPackage& find_package, const XMLElement* compiler)
      : folder_(folder), find_package_(find_package), compiler_(compiler) {}

  /// Renames the file of a <mesh>.
  void name(XMLElement* mesh) {
    const std::string named = attribute(*mesh, "filename");
    if (named.empty()) refuseElement(*mesh, "must have a filename");
    const auto in_folder = inMeshFolder(compiler_, named);
    const std::string file = in_folder && fs::is_regular_file(folder_ / *in_folder)
                                 ? (folder_ / *in_folder).string()
                                 : fileOf(*mesh, "filename", folder_, find_package_);
    if (fs::is_directory(file))
      refuseElement(*mesh, "names a folder, " + file + ": name a mesh in it");
    if (!isMeshKind(file)) {
      unreadable_.insert(named);
      return;
    }
    requireMesh(*mesh, named, file);
    std::string& name = names_[{file, attribute(*mesh, "scale")}];
    if (name.empty()) {
      const std::string kind = boost::to_lower_copy(fs::path(file).extension().string());
      name = std::to_string(names_.size()) + "_" + fs::path(file).stem().string() + kind;
      files.emplace_back(name, file);
    }
    mesh->SetAttribute("filename", name.c_str());
  }

  /// @throws std::invalid_argument with all files that MuJoCo does not read
  void requireReadable() const {
    if (unreadable_.empty()) return;
    const fs::path first(*unreadable_.begin());
    throw std::invalid_argument(
        "it has meshes that are no STL, OBJ or MSH files, which MuJoCo reads: " +
        join(unreadable_, ", ") + "; convert each, for example by `assimp export " +
        first.filename().string() + " " + first.stem().string() +
        ".stl` (Debian's assimp-utils), and name the new files in the model");
  }

  std::vector<std::pair<std::string, std::string>> files;  ///< by their new names

 private:
  fs::path folder_;
  const FindPackage& find_package_;
  const XMLElement* compiler_;
  std::map<std::pair<std::string, std::string>, std::string> names_;  // by file and scale
  std::set<std::string> unreadable_;
};

/// MuJoCo by default drops visual shapes, takes the mass of a link from its shapes where it has no
/// <inertial>, and refuses inertias that rounding has made impossible.
void completeCompiler(XMLElement* compiler) {
  const std::pair<const char*, const char*> ours[] = {
      {"discardvisual", "false"}, {"inertiafromgeom", "false"}, {"balanceinertia", "true"}};
  for (const auto& one : ours) {
    if (compiler->Attribute(one.first) == nullptr) compiler->SetAttribute(one.first, one.second);
  }
  compiler->SetAttribute("strippath", "false");  // MeshNames has applied both
  compiler->DeleteAttribute("meshdir");
}

/// Leaves out what MuJoCo does not read, such as <gazebo> and <transmission>.
void keepWhatMujocoReads(XMLElement* robot) {
  for (auto* child = robot->FirstChildElement(); child != nullptr;) {
    auto* const next = child->NextSiblingElement();
    if (!isOneOf({"link", "joint", "material", "mujoco"}, child->Value()))
      robot->DeleteChild(child);
    child = next;
  }
}

XMLElement* firstChild(XMLElement* parent, const char* name) {
  if (auto* const there = parent->FirstChildElement(name)) return there;
  return parent->InsertFirstChild(parent->GetDocument()->NewElement(name))->ToElement();
}

Coupling couplingOf(const XMLElement& joint, const std::vector<XMLElement*>& joints) {
  const XMLElement& mimic = *joint.FirstChildElement("mimic");
  Coupling coupling;
  coupling.follower = attribute(joint, "name");
  coupling.leader = attribute(mimic, "joint");
  coupling.multiplier = numberOr(joint, "mimic", "multiplier", 1.0);
  coupling.offset = numberOr(joint, "mimic", "offset", 0.0);
  std::vector<std::string> moving;
  for (const XMLElement* one : joints) {
    if (attribute(*one, "type") != "fixed") moving.push_back(attribute(*one, "name"));
  }
  if (coupling.leader == coupling.follower || !isOneOf(moving, coupling.leader)) {
    refuseElement(joint, "must mimic another joint that moves, got \"" + coupling.leader +
                             "\": " + suggestion(coupling.leader, moving));
  }
  return coupling;
}

/// Many files of robots have inertias that no body has, but nearly: there the smallest principal
/// inertia grows until it fits, and rotations about the other two axes keep theirs. MuJoCo would
/// put the mean of the three into the place of each.
void makePossible(XMLElement* link) {
  XMLElement* const inertial = link->FirstChildElement("inertial");
  XMLElement* const element =
      inertial == nullptr ? nullptr : inertial->FirstChildElement("inertia");
  if (element == nullptr) return;
  constexpr const char* kNames[3][3] = {
      {"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};
  Eigen::Matrix3d inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia(i, j) = numberOr(*inertial, "inertia", kNames[i][j], 0.0);
  }
  if (inertia.isZero(0.0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Vector3d principal = solver.eigenvalues();
  constexpr double kNearly = 2.0;
  constexpr double kSmallest = 1e-3;  // share of the largest
  if (principal[0] < -kSmallest * principal[2] ||
      principal[2] > kNearly * (principal[0] + principal[1])) {
    std::ostringstream got;
    got << principal[0] << ", " << principal[1] << ", " << principal[2];
    refuseElement(
        *link,
        "must have an <inertia> that a body can have: principal inertias > 0, none larger than "
        "the sum of the others, got " +
            got.str() + "; correct ixx to izz, which are about the centre of mass");
  }
  const double least = std::max(principal[2] - principal[1], kSmallest * principal[2]);
  if (principal[0] >= least) return;
  principal[0] = least + 1e-6 * principal[2];  // more than rounding takes away
  inertia = solver.eigenvectors() * principal.asDiagonal() * solver.eigenvectors().transpose();
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) element->SetAttribute(kNames[i][j], inertia(i, j));
  }
}

}  // namespace

Urdf readUrdf(const std::string& text, const std::string& path, const FindPackage& find_package) {
  const XmlDocument document = parseXml(text);
  XMLElement* const robot = document->RootElement();
  requireNoXacro(robot);
  keepWhatMujocoReads(robot);
  const std::vector<XMLElement*> links = children(*robot, "link");
  const std::vector<XMLElement*> joints = children(*robot, "joint");
  if (links.empty()) refuseElement(*robot, "has no <link>");
  requireNames(links);
  requireNames(joints);
  XMLElement* const mujoco = firstChild(robot, "mujoco");
  requireKnownBlock(*mujoco);
  for (const XMLElement* joint : joints) requireKnownType(*joint);
  requireTree(links, joints);
  Urdf urdf;
  for (XMLElement* joint : joints) {
    const std::string name = attribute(*joint, "name");
    const std::string type = attribute(*joint, "type");
    if (type == "fixed") {
      urdf.fixed[linkOf(*joint, "child")] = linkOf(*joint, "parent");
      continue;
    }
    if (const auto effort = number(*joint, "limit", "effort")) {
      if (*effort < 0.0) {
        refuseElement(*joint, "must have an effort >= 0, got \"" +
                                  attribute(*joint->FirstChildElement("limit"), "effort") + "\"");
      }
      urdf.efforts[name] = *effort;
    }
    if (type == "continuous") {  // has no positions to end at, whatever is written
      for (XMLElement* limit : children(*joint, "limit")) {
        limit->DeleteAttribute("lower");
        limit->DeleteAttribute("upper");
      }
    } else {
      requireLimits(*joint);
    }
    if (joint->FirstChildElement("mimic") != nullptr) {
      urdf.couplings.push_back(couplingOf(*joint, joints));
    }
  }
  requireNoCycle(urdf.couplings);
  const XMLElement* const option = mujoco->FirstChildElement("option");
  const XMLElement* const flag = option == nullptr ? nullptr : option->FirstChildElement("flag");
  urdf.contacts = flag != nullptr && attribute(*flag, "contact") == "enable";
  XMLElement* const compiler = firstChild(mujoco, "compiler");
  if (compiler->Attribute("boundinertia") == nullptr &&
      compiler->Attribute("inertiafromgeom") == nullptr) {
    std::map<std::string, const XMLElement*> by_name;
    for (const XMLElement* link : links) by_name[attribute(*link, "name")] = link;
    for (const XMLElement* joint : joints) {
      if (attribute(*joint, "type") == "fixed") continue;
      requireInertia(linkOf(*joint, "child"), by_name, urdf.fixed);
    }
    if (attribute(*compiler, "balanceinertia") != "true") {
      for (XMLElement* link : links) {
        if (urdf.fixed.count(attribute(*link, "name")) == 0) makePossible(link);
      }
    }
  }
  MeshNames meshes(fs::absolute(path).parent_path(), find_package, compiler);
  for (const XMLElement* link : links) {
    for (const char* kind : {"visual", "collision"}) {
      for (const XMLElement* part : children(*link, kind)) {
        XMLElement* const shape = requireShape(*link, *part);
        if (std::string(shape->Value()) == "mesh") meshes.name(shape);
      }
    }
  }
  meshes.requireReadable();
  urdf.model.meshes = meshes.files;
  completeCompiler(compiler);
  urdf.model.path = path;
  urdf.model.text = xmlText(*document);
  return urdf;
}

}  // namespace ddm
