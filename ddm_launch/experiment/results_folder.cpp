// A folder of results: one configuration, one process at a time.
// SPDX-License-Identifier: BSD-3-Clause
#include "results_folder.h"

#include <ddm_files/plain_file.h>
#include <unistd.h>

#include <boost/filesystem.hpp>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "code_version.h"
#include "saved_configuration.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;

void makeFolders(const std::string& path) {
  boost::system::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path)) {
    throw std::runtime_error("cannot make the folder " + path + ": " + error.message());
  }
}

}  // namespace

ResultsFolder::ResultsFolder(std::string path, YAML::Node configuration)
    : path_(std::move(path)), configuration_(std::move(configuration)) {
  if (path_.empty()) throw std::runtime_error("no folder was given for the results");
  if (!fs::exists(path_)) return;
  lock_ = std::make_unique<FolderLock>(path_);
  if (fs::exists(path_ + "/config.yaml")) {
    compareWith(path_ + "/config.yaml");
  } else if (fs::exists(path_ + "/trials.csv")) {
    throw std::runtime_error(path_ + " holds a trials.csv but no config.yaml: use another folder");
  }
}

void ResultsFolder::compareWith(const std::string& file) {
  SavedConfiguration there;
  try {
    there = readConfigurationText(readFile(file), file);
  } catch (const std::exception& e) {
    throw std::runtime_error(file + " cannot be read (" + e.what() + "): use another folder");
  }
  const std::string differences =
      differencesOf(there.values, keysOf(configuration_), fs::exists(path_ + "/trials.csv"));
  if (!differences.empty()) {
    throw std::runtime_error("the folder " + path_ +
                             " holds another experiment, use another folder:" + differences);
  }
  version_ = there.version;
  if (there.version != codeVersion()) {
    warnings_.push_back("the folder " + path_ + " was begun by version " + there.version +
                        " of the code, this is " + codeVersion() +
                        ": its results may not be comparable");
  }
}

void ResultsFolder::requireWritable() const {
  fs::path folder = fs::absolute(path_);
  while (!fs::exists(folder) && folder.has_parent_path()) folder = folder.parent_path();
  const bool is_folder = fs::is_directory(folder);
  if (is_folder && ::access(folder.c_str(), W_OK | X_OK) == 0) return;
  const int error = is_folder ? errno : ENOTDIR;
  throw std::runtime_error("cannot write into the folder " + path_ + ": " + folder.string() + ": " +
                           std::strerror(error));
}

void ResultsFolder::begin() {
  if (begun_) return;
  if (lock_ == nullptr) {
    makeFolders(path_);
    lock_ = std::make_unique<FolderLock>(path_);
    if (fs::exists(path_ + "/config.yaml")) {
      throw std::runtime_error("another experiment was begun in the folder " + path_ +
                               " meanwhile: use another folder");
    }
  }
  YAML::Node versioned(YAML::NodeType::Map);
  versioned["version"] = version_;
  for (const auto& block : configuration_) versioned[block.first] = block.second;
  const std::string file = path_ + "/config.yaml";
  const std::string text = YAML::Dump(versioned) + "\n";
  fs::remove(path_ + "/summary.yaml");
  if (!fs::exists(file) || readFile(file) != text) writeFileAtomically(file, text);
  begun_ = true;
}

void ResultsFolder::makeFolder(const std::string& name) {
  begin();
  makeFolders(path_ + "/" + name);
}

void ResultsFolder::write(const std::string& name, const std::string& content) {
  makeFolder(fs::path(name).parent_path().string());
  writeFileAtomically(path_ + "/" + name, content);
}

bool ResultsFolder::isFinished() const {
  const std::string file = path_ + "/summary.yaml";
  if (!fs::exists(file)) return false;
  try {
    return YAML::Load(readFile(file))["finished"].as<bool>(false);
  } catch (const YAML::Exception&) {
    return false;
  }
}

void ResultsFolder::finish(const YAML::Node& summary) {
  YAML::Node all(YAML::NodeType::Map);
  all["finished"] = true;
  for (const auto& entry : summary) all[entry.first] = entry.second;
  all["version"] = codeVersion();
  write("summary.yaml", YAML::Dump(all) + "\n");
}

}  // namespace ddm
