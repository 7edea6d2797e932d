// Finds and reads the files that belong to a model.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_files.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/crc.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <vector>

#include "xml_text.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

bool has(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

/// Attributes of an element whose values are file names.
std::vector<std::string> fileAttributes(const XMLElement& element) {
  const std::set<std::string> kinds = {"include", "mesh", "texture", "hfield", "skin"};
  std::vector<std::string> names;
  if (kinds.count(element.Value()) == 0) return names;
  for (auto* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    if (std::string(one->Name()).rfind("file", 0) == 0) names.emplace_back(one->Name());
  }
  return names;
}

/// Finds files in the same folders as MuJoCo: the folder of the model, and its folders of meshes
/// and textures.
class Collector {
 public:
  Collector(const fs::path& folder, const FindPackage& find_package)
      : folder_(folder), find_package_(find_package), folders_({folder}) {}

  void add(const fs::path& file) {
    if (!seen_.insert(file.lexically_normal().string()).second) return;
    const std::string bytes = readModelFile(file.string());
    checksum_.process_bytes(bytes.data(), bytes.size());
    const std::string mistaken = mistakenFor(bytes);
    if (!mistaken.empty()) refuseModel(file.string(), " ", mistaken);
    const std::size_t begin = bytes.find_first_not_of("\xef\xbb\xbf \t\r\n");
    // Neither a model nor an included file.
    if (begin == std::string::npos || bytes[begin] != '<') return;
    const XmlDocument document = parseXml(bytes);
    forEachElement(document->RootElement(), [this](XMLElement* element) { addNames(*element); });
    const std::set<std::string> names = names_;  // a copy, because add() changes names_
    for (const std::string& name : names) {
      for (const fs::path& path : pathsOf(name)) add(path);
    }
  }

  ModelFiles files() const {
    std::vector<std::string> missing;
    for (const std::string& name : names_) {
      if (pathsOf(name).empty()) missing.push_back(name);
    }
    char digest[32];  // the prefix keeps CSV and YAML readers from taking the digest for a number
    std::snprintf(digest, sizeof(digest), "crc32-%08x", checksum_.checksum());
    return {digest, boost::algorithm::join(missing, ", ")};
  }

 private:
  void addNames(const XMLElement& element) {
    for (const std::string& key : fileAttributes(element)) {
      const std::string name = attribute(element, key.c_str());
      try {
        names_.insert(resolved(name, find_package_));
      } catch (const std::invalid_argument&) {  // MuJoCo's own reader reports this name later
        names_.insert(name);
      }
    }
    if (std::string(element.Value()) != "compiler") return;
    for (const char* name : {"meshdir", "texturedir", "assetdir"}) {
      if (element.Attribute(name) != nullptr) folders_.insert(folder_ / element.Attribute(name));
    }
  }

  std::set<fs::path> pathsOf(const std::string& name) const {
    std::set<fs::path> paths;
    for (const fs::path& folder : folders_) {
      if (fs::is_regular_file(folder / name)) paths.insert(folder / name);
    }
    return paths;
  }

  fs::path folder_;
  const FindPackage& find_package_;
  std::set<fs::path> folders_;   // folders of the model, of its meshes and of its textures
  std::set<std::string> names_;  // names of files, as they stand in the models' texts
  std::set<std::string> seen_;
  boost::crc_32_type checksum_;
};

/// Text between the first two quotation marks after a word. Empty if the word does not occur.
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

ModelText readMjcf(const std::string& text, const std::string& path,
                   const FindPackage& find_package) {
  const XmlDocument document = parseXml(text);
  XMLElement* const root = document->RootElement();
  forEachElement(root, [&](XMLElement* element) {
    for (const std::string& key : fileAttributes(*element)) {
      const std::string name = attribute(*element, key.c_str());
      if (!has(name, "://")) continue;
      fs::path file = resolved(name, find_package);
      // MuJoCo takes the path of an include relative to the folder of the model, even if the path
      // is absolute.
      if (std::string(element->Value()) == "include") {
        file = fs::relative(file, fs::absolute(path).parent_path());
      }
      element->SetAttribute(key.c_str(), file.c_str());
    }
  });
  // Newer versions of MuJoCo set `autolimits` by default. Without it, version 2.2.2 refuses a range
  // without the attribute `limited`.
  XMLElement* const compiler = document->NewElement("compiler");
  compiler->SetAttribute("autolimits", "true");
  root->InsertFirstChild(compiler);
  return {path, xmlText(*document), {}};
}

std::string resolved(const std::string& name, const FindPackage& find_package) {
  const std::string file_scheme = "file://", package_scheme = "package://";
  if (name.rfind(file_scheme, 0) == 0) return name.substr(file_scheme.size());
  if (!has(name, "://")) return name;
  if (name.rfind(package_scheme, 0) != 0) {
    refuseModel("names \"", name,
                "\", which must be a path, package://PACKAGE/PATH or file://PATH");
  }
  const std::size_t begin = package_scheme.size();
  const std::size_t end = std::min(name.find('/', begin), name.size());
  const std::string package = name.substr(begin, end - begin);
  const std::string folder = package.empty() ? "" : find_package(package);
  if (!folder.empty()) return folder + name.substr(end);
  refuseModel(
      "names \"", name, "\", in which ",
      package.empty() ? "the package has no name: write package://PACKAGE/PATH with a package"
                      : "the package " + package +
                            " cannot be found: source the setup.bash of its workspace, or use a "
                            "package",
      " in ROS_PACKAGE_PATH, or a relative path, which counts from the folder of the model file");
}

std::string hintFor(const std::string& error) {
  constexpr char kNumbers[] = "the value of this attribute must be numbers, separated by blanks";
  constexpr char kInertia[] =
      "each body (link) that a joint moves needs a mass and inertias > 0 that a body can have: "
      "give "
      "it an <inertial>, or in MJCF a geom with mass";
  const std::pair<const char*, const char*> hints[] = {
      {"mesh file type",
       "MuJoCo reads STL, OBJ and MSH: convert the mesh, for example with `assimp export` of "
       "Debian's "
       "assimp-utils, or leave this shape out"},
      {"Non-PNG texture",
       "MuJoCo reads PNG textures: convert the image, for example by `convert` of ImageMagick"},
      {"qhull error",
       "the corners of this mesh lie in a plane or are too few, so that it has no hull: give it a "
       "thickness, or put a thin box in its place"},
      {"number of faces should be",
       "make the mesh smaller, at most 200000 triangles, for example with MeshLab; a file of text "
       "(ASCII STL) must be saved as binary STL"},
      {"ASCII file", "save the mesh as binary STL"},
      {"problem reading attribute", kNumbers},
      {"bad format in attribute", kNumbers},
      {"llocate",
       "it needs more memory than the 4 GB that it may: make its <size>, meshes or textures "
       "smaller"},
      {"mass and inertia", kInertia},
      {"inertia must", kInertia}};
  for (const auto& one : hints) {
    if (has(error, one.first)) return one.second;
  }
  for (const char* what :
       {"unrecognized attribute", "unrecognized element", "unrecognized model element",
        "unrecognized actuator type", "unrecognized equality", "invalid keyword"}) {
    if (!has(error, what)) continue;
    const std::string word = quotedAfter(error, what);
    return textOf("this is MuJoCo ", mj_versionString(), ", which does not know ",
                  word.empty() ? "this" : word,
                  ": it came later, or is misspelt; leave it out, or use a file for this version");
  }
  return "";
}

}  // namespace ddm
