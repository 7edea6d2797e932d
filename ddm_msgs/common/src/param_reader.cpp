// Strict configuration reader: collects and formats the problems.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/param_reader.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <stdexcept>
#include <utility>

#include "ddm_common/config_blocks.h"
#include "ddm_common/option_checks.h"

namespace ddm {
namespace {

/// All blocks of the parameter references in config/ of all packages. A program ignores the blocks
/// that it does not read, so that all programs can use the same files.
const std::set<std::string> kBlocks = {
    "plant",    "camera", "sim",        "show",  "robot", "image",      "model",      "training",
    "data_set", "mpc",    "controller", "pilco", "trial", "experiment", "evaluation", "start"};

/// Further keys of a saved configuration: the version and renderer that produced it, and the
/// success criterion.
const std::set<std::string> kOrigin = {"version", "renderer", "goal"};

/// " (did you mean horizon? known keys: horizon, epsilon)"
template <class Names>
std::string hint(const std::string& name, const char* kind, const Names& known) {
  const std::string list = boost::algorithm::join(known, ", ");
  const std::size_t limit = std::min<std::size_t>(3, (name.size() + 1) / 2);
  const std::string nearest = nearestName(name, known, limit);
  const std::string question = nearest.empty() ? "" : "did you mean " + nearest + "? ";
  return " (" + question + "known " + kind + ": " + list + ")";
}

}  // namespace

ParamReader::ParamReader(const YAML::Node& root, std::string source) : source_(std::move(source)) {
  if (root.IsDefined() && !root.IsNull() && !root.IsMap()) {
    throw std::invalid_argument("the configuration must be a map of blocks, got " + oneLine(root));
  }
  root_ = root.IsDefined() && root.IsMap() ? root : YAML::Node(YAML::NodeType::Map);
}

ParamReader ParamReader::fromFiles(const std::vector<std::string>& paths) {
  YAML::Node merged(YAML::NodeType::Map);
  std::string source;
  for (const std::string& path : paths) {
    overlay(readBlocks(path), &merged);
    source += (source.empty() ? "" : ", ") + path;
  }
  return ParamReader(merged, source);
}

bool ParamReader::has(const std::string& block) const {
  const YAML::Node& root = root_;
  return root[block].IsDefined();
}

YAML::Node ParamReader::openBlock(const std::string& block) {
  read_.insert(block);
  const YAML::Node& root = root_;
  const YAML::Node values = root[block];
  if (values.IsDefined() && values.IsMap()) return values;
  if (values.IsDefined() && !values.IsNull()) {
    report(block + " must be a block of keys, got " + oneLine(values));
  }
  return YAML::Node(YAML::NodeType::Map);
}

void ParamReader::reportUnknownKeys(const std::string& block, const YAML::Node& values,
                                    const std::vector<std::string>& known_keys) {
  for (const auto& entry : values) {
    const std::string key = oneLine(entry.first);
    if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      report("unknown key " + block + "/" + key + hint(key, "keys", known_keys));
    }
  }
}

void ParamReader::report(const std::string& problem) {
  // Two parts of one program may read the same block.
  if (std::find(problems_.begin(), problems_.end(), problem) == problems_.end()) {
    problems_.push_back(problem);
  }
}

std::vector<std::string> ParamReader::problems() const {
  std::vector<std::string> out = problems_;
  std::set<std::string> known = kBlocks;
  known.insert(read_.begin(), read_.end());
  for (const auto& entry : root_) {
    const std::string name = oneLine(entry.first);
    if (known.count(name) + ignored_.count(name) + kOrigin.count(name) > 0) continue;
    out.push_back("unknown block " + name + hint(name, "blocks", known));
  }
  return out;
}

void ParamReader::requireValid() const {
  const std::vector<std::string> all = problems();
  if (all.empty()) return;
  std::string message =
      "invalid configuration" + (source_.empty() ? "" : " (" + source_ + ")") + ":";
  for (const std::string& problem : all) message += "\n - " + problem;
  throw std::invalid_argument(message);
}

}  // namespace ddm
