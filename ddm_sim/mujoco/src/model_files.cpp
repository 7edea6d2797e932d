// The files that make up a model.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_files.h"

#include <boost/crc.hpp>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace ddm {
namespace {

namespace fs = std::filesystem;

std::string digestOf(const boost::crc_32_type& crc) {
  char digest[32];
  std::snprintf(digest, sizeof(digest), "crc32-%08x", crc.checksum());  // no reader's number
  return digest;
}

/// Values of the attributes of elements, where both names match.
std::vector<std::string> attributes(const std::string& text, const std::string& element,
                                    const std::string& name) {
  const std::regex tag("<(?:" + element + ")\\s[^<>]{1,10000}>");
  const std::regex attribute("\\b(?:" + name + ")\\s*=\\s*[\"']([^\"']{1,1000})[\"']");
  const std::sregex_iterator end;
  std::vector<std::string> values;
  for (std::sregex_iterator match(text.begin(), text.end(), tag); match != end; ++match) {
    const std::string inside = match->str();
    for (std::sregex_iterator value(inside.begin(), inside.end(), attribute); value != end;
         ++value) {
      values.push_back((*value)[1]);
    }
  }
  return values;
}

/// Finds files as MuJoCo does: beside the model, or in its folders of meshes and textures.
class Collector {
 public:
  Collector(const fs::path& folder, const FindPackage& find_package)
      : folder_(folder), find_package_(find_package), folders_({folder}) {}

  void add(const fs::path& file) {
    if (!seen_.insert(file.lexically_normal().string()).second) return;
    const std::string bytes = readModelFile(file.string());
    crc_.process_bytes(bytes.data(), bytes.size());
    if (file.extension() != ".xml" && file.extension() != ".urdf") return;
    const std::string text = withoutPackageUris(bytes, find_package_);
    for (const std::string& more : attributes(text, "compiler", "meshdir|texturedir|assetdir")) {
      folders_.insert(folder_ / more);
    }
    for (const std::string& name :
         attributes(text, "include|mesh|texture|hfield|skin", "file\\w*")) {
      names_.insert(name);
    }
    addNamed();
  }

  ModelFiles files() const {
    std::string missing;
    for (const std::string& name : names_) {
      if (pathsOf(name).empty()) missing += (missing.empty() ? "" : ", ") + name;
    }
    return {digestOf(crc_), missing};
  }

 private:
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

constexpr char kScheme[] = "package://";

/// MuJoCo by default drops visual shapes and the folders of meshes, takes the mass of a link from
/// its shapes where it has no <inertial>, and refuses inertias that rounding has made impossible.
constexpr char kCompiler[] =
    "<mujoco><compiler discardvisual=\"false\" strippath=\"false\" inertiafromgeom=\"false\" "
    "balanceinertia=\"true\"/></mujoco>";

bool has(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

}  // namespace

std::string readModelFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in || in.bad()) throw std::invalid_argument(path + " cannot be read");
  return bytes;
}

ModelFiles filesOf(const std::string& path, const FindPackage& find_package) {
  Collector files(fs::absolute(path).parent_path(), find_package);
  files.add(fs::absolute(path));
  return files.files();
}

std::string digestWith(const std::string& digest, const std::vector<std::string>& paths) {
  if (paths.empty()) return digest;
  boost::crc_32_type crc;
  crc.process_bytes(digest.data(), digest.size());
  for (const std::string& path : paths) {
    const std::string bytes = readModelFile(path);
    crc.process_bytes(bytes.data(), bytes.size());
  }
  return digestOf(crc);
}

bool isUrdf(const std::string& text) { return has(text, "<robot") && has(text, "</robot>"); }

bool hasMujocoBlock(const std::string& text) { return has(text, "<mujoco"); }

std::string urdfForMujoco(const std::string& text) {
  if (hasMujocoBlock(text)) return text;
  std::string out = text;
  return out.insert(out.rfind("</robot>"), kCompiler);
}

std::string hintFor(const std::string& text, const std::string& error) {
  if (has(text, "<xacro:") || has(text, "${")) {
    return "this is xacro: make URDF of it, xacro FILE > robot.urdf";
  }
  if (has(error, "mesh file type")) {
    return "MuJoCo reads STL, OBJ and MSH: convert the mesh, or leave this shape out";
  }
  if (has(error, "mass and inertia of moving bodies") && isUrdf(text)) {
    return "each link that a joint moves must have an <inertial>";
  }
  return "";
}

std::map<std::string, double> effortLimits(const std::string& text) {
  namespace pt = boost::property_tree;
  std::istringstream in(text);
  pt::ptree root;
  try {
    pt::read_xml(in, root);
  } catch (const pt::xml_parser_error& e) {
    throw std::invalid_argument("line " + std::to_string(e.line()) + ": " + e.message());
  }
  std::map<std::string, double> limits;
  const auto robot = root.get_child_optional("robot");
  if (!robot) return limits;
  for (const auto& child : *robot) {
    if (child.first != "joint") continue;
    const auto effort = child.second.get_optional<double>("limit.<xmlattr>.effort");
    if (effort) limits[child.second.get("<xmlattr>.name", "")] = *effort;
  }
  return limits;
}

std::string withoutPackageUris(std::string text, const FindPackage& find_package) {
  for (std::size_t at = 0; (at = text.find(kScheme, at)) != std::string::npos;) {
    const std::size_t name = at + sizeof(kScheme) - 1;
    const std::size_t end = text.find_first_of("/\"'<> \n", name);
    const std::string package = text.substr(name, end - name);
    const std::string folder = find_package(package);
    if (folder.empty()) {
      throw std::invalid_argument("package " + package +
                                  " cannot be found: source the setup.bash of its workspace");
    }
    text.replace(at, end - at, folder);
    at += folder.size();
  }
  return text;
}

}  // namespace ddm
