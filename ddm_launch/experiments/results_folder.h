// A folder of results: one configuration, one process at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {

/// Holds config.yaml, the effective configuration and version of the code, and in the end
/// summary.yaml. All files appear under their names only when they are complete.
class ResultsFolder {
 public:
  /// Makes the folder, or opens that of the same configuration; at most one process holds it.
  /// @param path           folder
  /// @param configuration  blocks by name
  /// @throws std::runtime_error if it cannot be written, is held by another process, or holds
  ///         results of another configuration (the keys that differ are named)
  ResultsFolder(std::string path, YAML::Node configuration);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Things a user should know about a folder that is used again.
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// Before the first result: keeps the configuration, and takes back an earlier summary. Not
  /// sooner: a command that is refused must leave all as it is.
  void begin() const;

  /// @param name  of a folder in this folder
  /// @throws std::runtime_error with path and reason
  void makeFolder(const std::string& name) const;

  /// @param name  of a file in this folder, may be in a folder within, which is made
  /// @throws std::runtime_error with path and reason
  void write(const std::string& name, const std::string& content) const;

  /// Writes summary.yaml, which begins with `finished: true` and ends with the version.
  void finish(const YAML::Node& summary) const;

 private:
  void lock();
  void compareWith(const std::string& file);

  std::string path_;
  YAML::Node configuration_;
  int lock_file_ = -1;
  std::vector<std::string> warnings_;
};

}  // namespace ddm
