// Checks a URDF file and rewrites the parts that MuJoCo would misread.
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/join.hpp>
#include <filesystem>
#include <iomanip>
#include <iterator>
#include <set>
#include <stdexcept>

#include "model_files.h"
#include "urdf_checks.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using boost::algorithm::join;

/// Gives each mesh file a unique name. MuJoCo distinguishes meshes only by the file name without
/// its folder.
class MeshNames {
 public:
  MeshNames(const fs::path& folder, const FindPackage& find_package, const XMLElement& compiler)
      : folder_(folder), find_package_(find_package), compiler_(compiler) {}

  /// Replaces the file name in a <mesh> by a unique name.
  void name(XMLElement* mesh) {
    const std::string named = attribute(*mesh, "filename");
    if (named.empty()) refuseElement(*mesh, "must have a filename");
    const fs::path file = fileOf(*mesh, named);
    if (fs::is_directory(file)) {
      refuseElement(*mesh, "names a folder, ", file.string(), ": name a mesh in it");
    }
    const std::string kind = boost::to_lower_copy(file.extension().string());
    if (!isOneOf({".stl", ".obj", ".msh"}, kind)) {
      unreadable_.insert(named);
      return;
    }
    const std::string mistaken = fs::is_regular_file(file)
                                     ? mistakenFor(readModelFile(file.string()))
                                     : "is not there: correct its name, or fetch the package that "
                                       "holds it";
    if (!mistaken.empty()) {
      refuseModel("the mesh \"", named, "\" in line ", mesh->GetLineNum(), " ", mistaken, " (",
                  file.string(), ")");
    }
    std::string& name = names_[{file.string(), attribute(*mesh, "scale")}];
    if (name.empty()) {
      name = std::to_string(names_.size()) + "_" + file.stem().string() + kind;
      files.emplace_back(name, file.string());
    }
    mesh->SetAttribute("filename", name.c_str());
  }

  /// @throws std::invalid_argument with all files in formats that MuJoCo does not read
  void requireReadable() const {
    if (unreadable_.empty()) return;
    const fs::path first(*unreadable_.begin());
    refuseModel("it has meshes that are no STL, OBJ or MSH files, which MuJoCo reads: ",
                join(unreadable_, ", "), "; convert each, for example by `assimp export ",
                first.filename().string(), " ", first.stem().string(),
                ".stl` (Debian's assimp-utils), and name the new files in the model");
  }

  std::vector<std::pair<std::string, std::string>> files;  ///< pairs of new name and file

 private:
  /// Searches a file first in the `meshdir` of the <mujoco> block, with the rules of MuJoCo (which
  /// strips the folder by default), then in the folder of the model.
  fs::path fileOf(const XMLElement& mesh, const std::string& named) const {
    if (compiler_.Attribute("meshdir") != nullptr) {
      const fs::path name = attribute(compiler_, "strippath") == "false"
                                ? fs::path(named)
                                : fs::path(named).filename();
      const fs::path file = folder_ / attribute(compiler_, "meshdir") / name;
      if (fs::is_regular_file(file)) return file;
    }
    try {
      return (folder_ / resolved(named, find_package_)).lexically_normal();
    } catch (const std::invalid_argument& e) {
      refuseElement(mesh, e.what());
    }
  }

  fs::path folder_;
  const FindPackage& find_package_;
  const XMLElement& compiler_;
  std::map<std::pair<std::string, std::string>, std::string> names_;  // by file and scale
  std::set<std::string> unreadable_;
};

/// Overrides four defaults of MuJoCo: MuJoCo drops visual shapes, computes the mass of a link
/// without <inertial> from its shapes, refuses inertias that rounding has made impossible, and
/// refuses meshes without a convex hull (flat ones), although only contacts need the hull.
void completeCompiler(bool contacts, XMLElement* compiler) {
  const std::pair<const char*, const char*> ours[] = {{"discardvisual", "false"},
                                                      {"inertiafromgeom", "false"},
                                                      {"balanceinertia", "true"},
                                                      {"convexhull", contacts ? "true" : "false"}};
  for (const auto& one : ours) {
    if (compiler->Attribute(one.first) == nullptr) compiler->SetAttribute(one.first, one.second);
  }
  // MeshNames has already applied strippath and meshdir.
  compiler->SetAttribute("strippath", "false");
  compiler->DeleteAttribute("meshdir");
}

/// Deletes elements that MuJoCo does not read, such as <gazebo>, after their facts are stored.
void keepWhatMujocoReads(XMLElement* robot, UrdfFacts* facts) {
  for (const XMLElement* transmission : children(*robot, "transmission")) {
    const XMLElement* const joint = transmission->FirstChildElement("joint");
    if (joint != nullptr) facts->transmissions.push_back(attribute(*joint, "name"));
  }
  for (XMLElement* child : children(*robot)) {
    const bool read = isOneOf({"link", "joint", "material", "mujoco"}, child->Value());
    if (!read) robot->DeleteChild(child);
  }
}

XMLElement* firstChild(XMLElement* parent, const char* name) {
  if (auto* const there = parent->FirstChildElement(name)) return there;
  return parent->InsertFirstChild(parent->GetDocument()->NewElement(name))->ToElement();
}

Coupling couplingOf(const XMLElement& joint, const std::vector<XMLElement*>& joints) {
  Coupling coupling;
  coupling.follower = attribute(joint, "name");
  coupling.leader = attribute(*joint.FirstChildElement("mimic"), "joint");
  coupling.multiplier = number(joint, "mimic", "multiplier").value_or(1.0);
  coupling.offset = numberOrZero(joint, "mimic", "offset");
  std::vector<XMLElement*> moving;
  std::copy_if(joints.begin(), joints.end(), std::back_inserter(moving),
               [](const XMLElement* one) { return attribute(*one, "type") != "fixed"; });
  if (coupling.leader == coupling.follower || !isOneOf(namesOf(moving), coupling.leader)) {
    refuseElement(joint, "must mimic another joint that moves, got \"", coupling.leader,
                  "\": ", suggestion(coupling.leader, namesOf(moving)));
  }
  return coupling;
}

/// Corrects inertias that are slightly impossible, as many URDF files have them: the smallest
/// principal inertia is increased until the triangle inequality holds, and the other two stay the
/// same. MuJoCo's `balanceinertia` would replace all three by their mean.
void makePossible(XMLElement* link) {
  XMLElement* const inertial = link->FirstChildElement("inertial");
  XMLElement* const element =
      inertial == nullptr ? nullptr : inertial->FirstChildElement("inertia");
  if (element == nullptr) return;
  constexpr const char* kNames[3][3] = {
      {"ixx", "ixy", "ixz"}, {"ixy", "iyy", "iyz"}, {"ixz", "iyz", "izz"}};
  Eigen::Matrix3d inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia(i, j) = numberOrZero(*inertial, "inertia", kNames[i][j]);
  }
  if (inertia.isZero(0.0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Vector3d principal = solver.eigenvalues();
  constexpr double kNearly = 2.0;
  constexpr double kSmallest = 1e-3;  // smallest principal inertia, as a share of the largest
  if (principal[0] < -kSmallest * principal[2] ||
      principal[2] > kNearly * (principal[0] + principal[1])) {
    refuseElement(
        *link,
        "must have an <inertia> that a body can have: principal inertias > 0, none larger than the "
        "sum of the others, got ",
        principal[0], ", ", principal[1], ", ", principal[2],
        "; correct ixx to izz, which are about the centre of mass");
  }
  const double least = std::max(principal[2] - principal[1], kSmallest * principal[2]);
  if (principal[0] >= least) return;
  principal[0] = least + 1e-6 * principal[2];  // the margin covers later rounding
  inertia = solver.eigenvectors() * principal.asDiagonal() * solver.eigenvectors().transpose();
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      // As text, because tinyxml2 writes numbers with the decimal comma of the locale.
      const std::string number = textOf(std::setprecision(17), inertia(i, j));
      element->SetAttribute(kNames[i][j], number.c_str());
    }
  }
}

/// Stores the facts of a joint that MuJoCo's model does not contain.
void readJoint(const XMLElement& joint, const std::vector<XMLElement*>& joints, Urdf* urdf) {
  const std::string name = attribute(joint, "name");
  if (attribute(joint, "type") == "fixed") {
    urdf->facts.fixed[linkOf(joint, "child")] = linkOf(joint, "parent");
    return;
  }
  if (const auto effort = number(joint, "limit", "effort")) {
    if (*effort < 0.0) refuseElement(joint, "must have an effort >= 0, got \"", *effort, "\"");
    urdf->facts.efforts[name] = *effort;
  }
  if (joint.FirstChildElement("mimic") == nullptr) return;
  urdf->couplings.push_back(couplingOf(joint, joints));
  urdf->facts.leaders[name] = urdf->couplings.back().leader;
}

/// Checks masses and inertias of the links that a joint moves, unless a setting in the <mujoco>
/// block lets MuJoCo replace them. The inertia of the root link has no effect.
void completeInertias(const std::vector<XMLElement*>& links, const std::vector<XMLElement*>& joints,
                      const std::map<std::string, std::string>& fixed, const XMLElement& compiler) {
  if (compiler.Attribute("boundinertia") != nullptr ||
      compiler.Attribute("inertiafromgeom") != nullptr) {
    return;
  }
  std::map<std::string, XMLElement*> by_name;
  for (XMLElement* link : links) by_name[attribute(*link, "name")] = link;
  for (const XMLElement* joint : joints) {
    if (attribute(*joint, "type") == "fixed") continue;
    const std::string moved = linkOf(*joint, "child");
    requireInertia(moved, by_name, fixed);
    if (attribute(compiler, "balanceinertia") != "true") makePossible(by_name.at(moved));
  }
}

}  // namespace

Urdf readUrdf(const std::string& text, const std::string& path, const FindPackage& find_package) {
  Urdf urdf;
  const XmlDocument document = parseXml(text);
  XMLElement* const robot = document->RootElement();
  requireNoXacro(robot);
  keepWhatMujocoReads(robot, &urdf.facts);
  const std::vector<XMLElement*> links = children(*robot, "link");
  const std::vector<XMLElement*> joints = children(*robot, "joint");
  if (links.empty()) refuseElement(*robot, "has no <link>");
  requireNames(links);
  requireNames(joints);
  XMLElement* const mujoco = firstChild(robot, "mujoco");
  requireKnownBlock(*mujoco);
  for (const XMLElement* joint : joints) requireTypeAndLimits(*joint);
  requireTree(links, joints);
  for (const XMLElement* joint : joints) {
    readJoint(*joint, joints, &urdf);
    if (attribute(*joint, "type") != "continuous") continue;
    // A continuous joint has no limits, even if the file has values.
    for (XMLElement* limit : children(*joint, "limit")) {
      limit->DeleteAttribute("lower");
      limit->DeleteAttribute("upper");
    }
  }
  requireNoCycle(urdf.facts.leaders);
  const XMLElement* const option = mujoco->FirstChildElement("option");
  const XMLElement* const flag = option == nullptr ? nullptr : option->FirstChildElement("flag");
  urdf.contacts = flag != nullptr && attribute(*flag, "contact") == "enable";
  XMLElement* const compiler = firstChild(mujoco, "compiler");
  completeInertias(links, joints, urdf.facts.fixed, *compiler);
  MeshNames meshes(fs::absolute(path).parent_path(), find_package, *compiler);
  for (const XMLElement* link : links) {
    for (const char* kind : {"visual", "collision"}) {
      for (const XMLElement* part : children(*link, kind)) {
        XMLElement* const shape = requireShape(*link, *part);
        if (std::string(shape->Value()) == "mesh") meshes.name(shape);
      }
    }
  }
  meshes.requireReadable();
  completeCompiler(urdf.contacts, compiler);
  urdf.model = {path, xmlText(*document), meshes.files};
  return urdf;
}

}  // namespace ddm
