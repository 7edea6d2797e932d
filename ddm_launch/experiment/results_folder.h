// A folder of results: one configuration, one process at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/folder_lock.h>
#include <yaml-cpp/yaml.h>

#include <memory>
#include <string>
#include <vector>

namespace ddm {

/// The differences with which an experiment must not go on, a line each; empty: none. What is
/// chosen by looking at the robot (crop and goal) may change until the first trial is finished.
/// @param there  blocks by name, with today's keys; anything that is not a block is left out
/// @param here   likewise
std::string differencesOf(const YAML::Node& there, const YAML::Node& here, bool trial_finished);

/// Version of the package, commit, and instruction set if it is not the usual one: "1.0.0 (1a2b3c4)".
std::string codeVersion();

/// Holds config.yaml, the effective configuration and the version of the code that began, and in
/// the end summary.yaml. All files appear under their names only when they are complete.
class ResultsFolder {
 public:
  /// Looks at the folder, which need not exist, and changes nothing. If it is there, it is locked
  /// while this object lives, by the file .lock.
  /// @param path           folder
  /// @param configuration  blocks by name
  /// @throws std::runtime_error if it is held by another process, or holds results of another
  ///         configuration (the keys that differ are named)
  ResultsFolder(std::string path, YAML::Node configuration);
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Things a user should know about a folder that is used again.
  const std::vector<std::string>& warnings() const { return warnings_; }
  void warn(const std::string& text) { warnings_.push_back(text); }

  /// Makes the folder, keeps the configuration with the version that began, and takes back an
  /// earlier summary. Called by all that writes: before the first result, and no sooner, since a
  /// command that is refused must leave everything as it is.
  /// @throws std::runtime_error with path and reason, also if another process has begun meanwhile
  void begin();

  /// @param name  of a folder in this folder
  /// @throws std::runtime_error with path and reason
  void makeFolder(const std::string& name);

  /// @param name  of a file in this folder, may be in a folder within, which is made
  /// @throws std::runtime_error with path and reason
  void write(const std::string& name, const std::string& content);

  /// Whether there is a summary.yaml that says so.
  bool isFinished() const;

  /// Where isFinished(), sets the time of summary.yaml to now and changes nothing else: its caller
  /// can tell a call that found everything finished from one that was refused.
  /// @return isFinished()
  bool confirmSummary() const;

  /// Writes summary.yaml, which begins with `finished: true` and ends with the version.
  void finish(const YAML::Node& summary);

 protected:
  /// False if crop or goal of the robot have been chosen anew since config.yaml was written: images
  /// recorded before do not go with those to come.
  bool recordingsFit() const { return recordings_fit_; }

 private:
  void compareWith(const std::string& file);

  std::string path_;
  YAML::Node configuration_;
  std::string version_ = codeVersion();     // of the code that began
  std::unique_ptr<const FolderLock> lock_;  // null: the folder is not there yet
  bool begun_ = false;
  bool recordings_fit_ = true;
  std::vector<std::string> warnings_;
};

}  // namespace ddm
