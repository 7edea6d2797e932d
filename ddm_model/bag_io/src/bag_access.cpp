// Which bags a request may name: ROS 1 does not know who asks.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_access.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace ddm {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // as many as Linux follows

/// The file that opening this path would read or make.
fs::path target(fs::path path) {
  path = fs::absolute(path);
  // weakly_canonical() takes a link for a plain name where its target is missing.
  for (int links = 0; fs::is_symlink(fs::symlink_status(path)); ++links) {
    if (links == kMaxLinks) throw std::runtime_error("too many links in " + path.string());
    path = path.parent_path() / fs::read_symlink(path);  // an absolute one replaces the folder
  }
  return fs::weakly_canonical(path);
}

bool isIn(const fs::path& path, const fs::path& place) {
  return std::mismatch(place.begin(), place.end(), path.begin(), path.end()).first == place.end();
}

}  // namespace

void BagAccess::require(const std::string& path) const {
  if (path.empty() || path.find('\0') != std::string::npos) {
    throw std::runtime_error("bag '" + std::string(path.c_str()) + "' is not a path");
  }
  std::string known;
  const fs::path asked = target(path);
  for (const std::string& bag : bags) {
    const fs::path place = target(bag);
    if (isIn(asked, place)) return;
    known += (known.empty() ? "" : ", ") + place.string();
  }
  const std::string meant = asked == fs::path(path) ? "" : " (" + asked.string() + ")";
  throw std::runtime_error("bag " + path + meant + " must lie in " +
                           (known.empty() ? "no folder at all" : known) +
                           ", for this node may touch no others: add its folder to access/bags");
}

void BagAccess::requireNew(const std::string& path) const {
  require(path);
  require(path + ".active");  // what is opened, and may be a link too
  if (fs::path(path).extension() != ".bag") {
    throw std::runtime_error("bag " + path + ": the name of a recording must end in .bag");
  }
  if (fs::exists(fs::symlink_status(path))) {
    throw std::runtime_error("bag " + path +
                             " exists already: remove it, or record under another name");
  }
}

std::vector<std::string> BagAccess::problems() const {
  if (std::find(bags.begin(), bags.end(), "") == bags.end()) return {};
  return {"access/bags must have no empty entry, got ''"};
}

}  // namespace ddm
