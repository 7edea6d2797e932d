// Reads the bags of all trials as one data set, each bag only once.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_cache.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "bag_texts.h"

namespace ddm {

const BagContent& BagCache::contentOf(const std::string& path) {
  std::error_code missing;  // readBag() says more about a missing file
  const auto modified = std::filesystem::last_write_time(path, missing);
  const std::uintmax_t bytes = std::filesystem::file_size(path, missing);
  const auto known = entries_.find(path);
  if (known != entries_.end() && known->second.modified == modified &&
      known->second.bytes == bytes) {
    return known->second.content;
  }
  entries_.erase(path);
  Entry entry{modified, bytes, readBag(path, image_size_, options_)};
  for (const std::string& note : entry.content.notes) {
    if (warn_) warn_("bag " + path + ": " + note);
  }
  return entries_.emplace(path, std::move(entry)).first->second.content;
}

DataSet BagCache::read(const std::vector<std::string>& paths, const KeepGoing& keep_going) {
  if (paths.empty()) refuseBag("no bag was given: there is nothing to learn from");
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const bool wanted = std::find(paths.begin(), paths.end(), entry->first) != paths.end();
    entry = wanted ? std::next(entry) : entries_.erase(entry);
  }
  const std::string camera = contentOf(paths.front()).camera;
  const int torque_dim = contentOf(paths.front()).data.torqueDim();
  DataSet data(image_size_, torque_dim);
  DifferentBags different;
  for (const std::string& path : paths) {
    if (&path != &paths.front() && keep_going && !keep_going()) {
      throw ReadingCancelled("reading bags was cancelled");
    }
    const BagContent& content = contentOf(path);
    const bool fits = content.camera == camera || options_.ofOthers();
    if (!fits || content.data.torqueDim() != torque_dim) {
      refuseBag("bag ", path, " (", content.camera, ", ", content.data.torqueDim(),
                " torque(s)) and bag ", paths.front(), " (", camera, ", ", torque_dim,
                " torque(s)) are of different robots: train on one of them");
    }
    different.require(path, content);
    data.append(content.data);
  }
  return data;
}

}  // namespace ddm
