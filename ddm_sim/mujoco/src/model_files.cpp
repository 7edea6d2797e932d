// The files that make up a model.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_files.h"

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/crc.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "xml_text.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

/// Finds files as MuJoCo does: beside the model, or in its folders of meshes and textures.
class Collector {
 public:
  Collector(const fs::path& folder, const FindPackage& find_package)
      : folder_(folder), find_package_(find_package), folders_({folder}) {}

  void add(const fs::path& file) {
    if (!seen_.insert(file.lexically_normal().string()).second) return;
    const std::string bytes = readModelFile(file.string());
    crc_.process_bytes(bytes.data(), bytes.size());
    const std::string mistaken = mistakenFor(bytes);
    if (!mistaken.empty()) throw std::invalid_argument(file.string() + " " + mistaken);
    const std::size_t begin = bytes.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (begin == std::string::npos || bytes[begin] != '<') return;  // neither model nor include
    const XmlDocument document = parseXml(bytes);
    forEachElement(document->RootElement(), [this](XMLElement* element) { addFolders(*element); });
    forEachFile(document->RootElement(), [this](XMLElement* element, const std::string& name) {
      insert(attribute(*element, name.c_str()));
    });
    addNamed();
  }

  ModelFiles files() const {
    std::string missing;
    for (const std::string& name : names_) {
      if (pathsOf(name).empty()) missing += (missing.empty() ? "" : ", ") + name;
    }
    char digest[32];
    std::snprintf(digest, sizeof(digest), "crc32-%08x", crc_.checksum());  // no reader's number
    return {digest, missing};
  }

 private:
  void insert(const std::string& file) {
    try {
      names_.insert(resolved(file, find_package_));
    } catch (const std::invalid_argument&) {  // refused where MuJoCo is to read it
      names_.insert(file);
    }
  }

  void addFolders(const XMLElement& element) {
    if (std::string(element.Value()) == "include" && element.Attribute("file") != nullptr) {
      insert(attribute(element, "file"));
    }
    if (std::string(element.Value()) != "compiler") return;
    for (const char* name : {"meshdir", "texturedir", "assetdir"}) {
      if (element.Attribute(name) != nullptr) folders_.insert(folder_ / element.Attribute(name));
    }
  }

  std::set<std::string> pathsOf(const std::string& name) const {
    std::set<std::string> paths;
    for (const fs::path& folder : folders_) {
      if (fs::is_regular_file(folder / name)) paths.insert((folder / name).string());
    }
    return paths;
  }

  void addNamed() {
    const std::set<std::string> names = names_;  // adding a file adds its names
    for (const std::string& name : names) {
      for (const std::string& path : pathsOf(name)) add(path);
    }
  }

  fs::path folder_;
  const FindPackage& find_package_;
  std::set<fs::path> folders_;   // of the model, its meshes and textures
  std::set<std::string> names_;  // as the texts have them
  std::set<std::string> seen_;
  boost::crc_32_type crc_;
};

constexpr char kPackage[] = "package://";
constexpr char kFile[] = "file://";

bool has(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

/// What stands between the first two quotation marks behind a word; empty if the word is not there.
std::string quotedAfter(const std::string& text, const std::string& word) {
  const std::size_t begin = text.find('\'', std::min(text.find(word), text.size()));
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find('\'', begin + 1) + 1 - begin);
}

}  // namespace

ModelFiles filesOf(const ModelText& model, const FindPackage& find_package) {
  Collector files(fs::absolute(model.path).parent_path(), find_package);
  files.add(fs::absolute(model.path));
  for (const auto& mesh : model.meshes) files.add(mesh.second);
  return files.files();
}

std::string rootOf(const std::string& text) {
  return boost::to_lower_copy(std::string(parseXml(text)->RootElement()->Value()));
}

ModelText readMjcf(const std::string& text, const std::string& path,
                   const FindPackage& find_package) {
  const XmlDocument document = parseXml(text);
  XMLElement* const root = document->RootElement();
  forEachFile(root, [&find_package](XMLElement* element, const std::string& name) {
    element->SetAttribute(name.c_str(),
                          resolved(attribute(*element, name.c_str()), find_package).c_str());
  });
  forEachElement(root, [&](XMLElement* element) {
    const std::string file = attribute(*element, "file");
    if (std::string(element->Value()) != "include" || !has(file, "://")) return;
    const fs::path folder = fs::absolute(path).parent_path();  // from where MuJoCo counts
    element->SetAttribute("file", fs::relative(resolved(file, find_package), folder).c_str());
  });
  // As newer versions of MuJoCo do: without it, version 2.2.2 refuses a range that has no
  // `limited`.
  XMLElement* const compiler = document->NewElement("compiler");
  compiler->SetAttribute("autolimits", "true");
  root->InsertFirstChild(compiler);
  return {path, xmlText(*document), {}};
}

std::string resolved(const std::string& name, const FindPackage& find_package) {
  if (name.rfind(kFile, 0) == 0) return name.substr(sizeof(kFile) - 1);
  if (name.rfind(kPackage, 0) != 0) {
    if (!has(name, "://")) return name;
    throw std::invalid_argument("names \"" + name +
                                "\", which must be a path, package://PACKAGE/PATH or file://PATH");
  }
  const std::size_t begin = sizeof(kPackage) - 1;
  const std::size_t end = std::min(name.find('/', begin), name.size());
  const std::string package = name.substr(begin, end - begin);
  const std::string folder = package.empty() ? "" : find_package(package);
  if (!folder.empty()) return folder + name.substr(end);
  throw std::invalid_argument(
      "names \"" + name + "\", in which " +
      (package.empty()
           ? "the package has no name: write package://PACKAGE/PATH with a package"
           : "the package " + package +
                 " cannot be found: source the setup.bash of its workspace, or use a package") +
      " in ROS_PACKAGE_PATH, or a relative path, which counts from the folder of the model file");
}

bool isMeshKind(const std::string& file) {
  const std::string kind = boost::to_lower_copy(fs::path(file).extension().string());
  return kind == ".stl" || kind == ".obj" || kind == ".msh";
}

void requireMesh(const XMLElement& element, const std::string& named, const std::string& file) {
  const std::string line =
      "the mesh \"" + named + "\" in line " + std::to_string(element.GetLineNum()) + " ";
  if (!fs::is_regular_file(file)) {
    throw std::invalid_argument(line + "is not there: no file " + file +
                                "; correct its name, or fetch the package that holds it");
  }
  const std::string bytes = readModelFile(file);
  const std::string mistaken = mistakenFor(bytes);
  if (!mistaken.empty()) throw std::invalid_argument(line + mistaken + " (" + file + ")");
}

std::string hintFor(const std::string& error) {
  if (has(error, "mesh file type")) {
    return "MuJoCo reads STL, OBJ and MSH: convert the mesh, for example with `assimp export` of "
           "Debian's "
           "assimp-utils, or leave this shape out";
  }
  if (has(error, "Non-PNG texture")) {
    return "MuJoCo reads PNG textures: convert the picture, for example by `convert` of "
           "ImageMagick";
  }
  if (has(error, "qhull error")) {
    return "the corners of this mesh lie in a plane or are too few, so that it has no hull: give "
           "it "
           "a thickness, or put a thin box in its place";
  }
  if (has(error, "number of faces should be")) {
    return "make the mesh smaller, at most 200000 triangles, for example with MeshLab; a file of "
           "text "
           "(ASCII STL) must be saved as binary STL";
  }
  if (has(error, "ASCII file")) return "save the mesh as binary STL";
  if (has(error, "problem reading attribute") || has(error, "bad format in attribute")) {
    return "the value of this attribute must be numbers, separated by blanks";
  }
  if (has(error, "llocate")) {
    return "it needs more memory than the 4 GB that it may: make its <size>, meshes or textures "
           "smaller";
  }
  if (has(error, "mass and inertia") || has(error, "inertia must")) {
    return "each body (link) that a joint moves needs a mass and inertias > 0 that a body can "
           "have: give it an "
           "<inertial>, or in MJCF a geom with mass";
  }
  for (const char* what :
       {"unrecognized attribute", "unrecognized element", "unrecognized model element",
        "unrecognized actuator type", "unrecognized equality", "invalid keyword"}) {
    if (!has(error, what)) continue;
    const std::string word = quotedAfter(error, what);
    return "this is MuJoCo " + std::string(mj_versionString()) + ", which does not know " +
           (word.empty() ? "this" : word) +
           ": it came later, or is misspelt; leave it out, or use a file for this version";
  }
  return "";
}

}  // namespace ddm
