// A folder of results: one configuration, one process at a time.
// SPDX-License-Identifier: BSD-3-Clause
#include "results_folder.h"

#include <ddm_model/plain_file.h>
#include <fcntl.h>
#include <sys/file.h>
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

}  // namespace

ResultsFolder::ResultsFolder(std::string path, YAML::Node configuration)
    : path_(std::move(path)), configuration_(std::move(configuration)) {
  if (path_.empty()) throw std::runtime_error("no folder was given for the results");
  boost::system::error_code error;
  fs::create_directories(path_, error);
  if (!fs::is_directory(path_)) {
    throw std::runtime_error("cannot make the folder " + path_ + ": " + error.message());
  }
  lock();
  try {
    if (fs::exists(path_ + "/config.yaml")) {
      compareWith(path_ + "/config.yaml");
    } else if (fs::exists(path_ + "/trials.csv")) {
      throw std::runtime_error(path_ +
                               " holds a trials.csv but no config.yaml: use another folder");
    }
  } catch (...) {
    ::close(lock_file_);
    throw;
  }
}

ResultsFolder::~ResultsFolder() { ::close(lock_file_); }

/// The kernel lets go of the lock when the process ends, however it ends.
void ResultsFolder::lock() {
  const std::string file = path_ + "/.lock";
  lock_file_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_file_ < 0) {
    throw std::runtime_error("cannot write into the folder " + path_ + ": " + std::strerror(errno));
  }
  if (::flock(lock_file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_file_);
    throw std::runtime_error("another experiment is running in the folder " + path_ +
                             ": wait for it, or use another folder");
  }
}

void ResultsFolder::compareWith(const std::string& file) {
  SavedConfiguration there;
  try {
    there = readConfigurationText(readFile(file), file);
  } catch (const std::exception& e) {
    throw std::runtime_error(file + " cannot be read (" + e.what() + "): use another folder");
  }
  const std::string differences = differencesOf(there.values, keysOf(configuration_));
  if (!differences.empty()) {
    throw std::runtime_error("the folder " + path_ +
                             " holds another experiment, use another folder:" + differences);
  }
  if (there.version != codeVersion()) {
    warnings_.push_back("the folder " + path_ + " was begun by version " + there.version +
                        " of the code, this is " + codeVersion() +
                        ": its results may not be comparable");
  }
}

void ResultsFolder::begin() const {
  YAML::Node versioned(YAML::NodeType::Map);
  versioned["version"] = codeVersion();
  for (const auto& block : configuration_) versioned[block.first] = block.second;
  write("config.yaml", YAML::Dump(versioned) + "\n");
  boost::system::error_code error;
  fs::remove(path_ + "/summary.yaml", error);
}

void ResultsFolder::makeFolder(const std::string& name) const {
  const fs::path folder = fs::path(path_) / name;
  boost::system::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error("cannot make the folder " + folder.string() + ": " + error.message());
  }
}

void ResultsFolder::write(const std::string& name, const std::string& content) const {
  makeFolder(fs::path(name).parent_path().string());
  writeFileAtomically(path_ + "/" + name, content);
}

void ResultsFolder::finish(const YAML::Node& summary) const {
  YAML::Node all(YAML::NodeType::Map);
  all["finished"] = true;
  for (const auto& entry : summary) all[entry.first] = entry.second;
  all["version"] = codeVersion();
  write("summary.yaml", YAML::Dump(all) + "\n");
}

}  // namespace ddm
