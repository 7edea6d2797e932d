// The trials recorded so far as one data set; each bag is read once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// Keeps what it has read of a bag until the file changes.
class BagCache {
 public:
  BagCache(int image_size, BagOptions options)
      : image_size_(image_size), options_(std::move(options)) {}

  /// All bags as one data set, each a trial of its own, in the order given.
  /// @throws std::runtime_error as readBag() does, or if camera or number of torques differ between
  ///         bags, or if there is no bag or one is given twice
  DataSet read(const std::vector<std::string>& paths);

 private:
  struct Entry {
    std::int64_t modified;  // [ns]
    std::uintmax_t bytes;
    BagContent content;
  };

  const BagContent& contentOf(const std::string& path);

  int image_size_;
  BagOptions options_;
  std::map<std::string, Entry> entries_;
};

}  // namespace ddm
