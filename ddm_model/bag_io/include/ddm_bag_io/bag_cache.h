// Reads the bags of all trials as one data set, each bag only once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// Thrown by BagCache::read() if keep_going returns false.
struct ReadingCancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads bags and stores their content until the file changes or read() is called without it.
class BagCache {
 public:
  using Warn = std::function<void(const std::string& note)>;
  using KeepGoing = std::function<bool()>;

  /// @param image_size  width and height of the images in the data set [pixels]
  /// @param warn        (optional) receives the notes of each bag that is read, see BagContent
  BagCache(int image_size, BagOptions options, Warn warn = nullptr)
      : image_size_(image_size), options_(std::move(options)), warn_(std::move(warn)) {}

  /// Reads all bags as one data set, each as a trial of its own, in the given order. The last bag
  /// with a goal image determines the goal image.
  /// @param keep_going  (optional) called between two bags
  /// @throws std::runtime_error like readBag(); also if bags differ in camera or number of torques,
  ///         if there is no bag, or if a bag is given twice
  /// @throws ReadingCancelled if keep_going returns false
  DataSet read(const std::vector<std::string>& paths, const KeepGoing& keep_going = nullptr);

 private:
  struct Entry {
    std::filesystem::file_time_type modified;
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
