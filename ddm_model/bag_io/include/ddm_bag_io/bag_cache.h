// The trials recorded so far as one data set; each bag is read once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// What BagCache::read() throws if it is told to end.
struct ReadingCancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Keeps what it has read of a bag until the file changes or is no longer asked for.
class BagCache {
 public:
  using Warn = std::function<void(const std::string& note)>;
  using KeepGoing = std::function<bool()>;

  /// @param warn  (optional) is told the notes of each bag when it is read, see BagContent
  BagCache(int image_size, BagOptions options, Warn warn = nullptr)
      : image_size_(image_size), options_(std::move(options)), warn_(std::move(warn)) {}

  /// All bags as one data set, each a trial of its own, in the order given. The goal image is that of
  /// the last bag that has one.
  /// @throws std::runtime_error as readBag() does, or if camera or number of torques differ between
  ///         bags, or if there is no bag or one is given twice
  /// @param keep_going  (optional) asked between two bags
  /// @throws ReadingCancelled if keep_going returns false
  DataSet read(const std::vector<std::string>& paths, const KeepGoing& keep_going = nullptr);

 private:
  struct Entry {
    std::int64_t modified;  // [ns]
    std::uintmax_t bytes;
    BagContent content;
  };

  const BagContent& contentOf(const std::string& path);

  int image_size_;
  BagOptions options_;
  Warn warn_;
  std::map<std::string, Entry> entries_;
};

}  // namespace ddm
