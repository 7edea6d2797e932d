// pilco_check: compares everything that PILCO computes with a file of reference values.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_files/plain_file.h>
#include <ddm_model/solver_log.h>
#include <ddm_params/tool.h>
#include <ddm_params/yaml_text.h>

#include <algorithm>
#include <boost/format.hpp>
#include <iomanip>
#include <iostream>
#include <set>
#include <stdexcept>

#include "check/case.h"
#include "ddm_pilco/messages.h"

namespace ddm::pilco::check {
namespace {

/// Those kinds that a file has.
using Results = std::map<std::string, KindResult>;

void checkCase(const YAML::Node& node, Check check, std::set<std::string>* ids,
               KindResult* result) {
  std::string id = "number " + std::to_string(++result->cases);
  try {
    require(node.IsMap() && node["id"] && node["id"].IsScalar(), "must have an id");
    id = node["id"].Scalar();
    require(ids->insert(id).second, "field id: is there twice");
    Case reference(node, id, result);
    check(&reference);
    reference.requireAllRead();
  } catch (const std::exception& e) {
    result->problems.push_back("case " + id + ", " + e.what());
  }
}

KindResult checkKind(const std::string& name, const YAML::Node& cases) {
  KindResult result;
  std::set<std::string> ids;
  const auto known = kinds().find(name);
  if (known == kinds().end()) {
    result.problems.push_back("unknown kind, not compared");
  } else if (!cases.IsSequence() || cases.size() == 0) {
    result.problems.push_back("must be a list of cases, nothing was compared");
  } else {
    for (const YAML::Node& node : cases) checkCase(node, known->second, &ids, &result);
  }
  return result;
}

/// Compares every case of a file. A case that cannot be read is a problem of its kind, the others
/// are compared all the same.
/// @throws std::exception with the path if the file does not hold an object of kinds
Results checkFile(const std::string& path) {
  std::string text = readFile(path);
  std::replace(text.begin(), text.end(), '\t', ' ');  // JSON is YAML, but for tabs
  const YAML::Node root = parseYaml(text, path);
  require(root.IsMap(), path, ": must be an object with kinds of cases");
  Results results;
  for (const auto& item : root) {
    const std::string name = item.first.as<std::string>();
    if (name == "meta") continue;
    const bool first = results.emplace(name, checkKind(name, item.second)).second;
    if (!first) results[name].problems.push_back("the file has this kind twice");
  }
  return results;
}

/// Prints a table, then each problem by kind, case and field.
/// @throws std::runtime_error with the kinds that failed
void print(const Results& results) {
  const auto scientific = [](double value, int digits) {
    return message(std::scientific, std::setprecision(digits), value);
  };
  std::string problems, failed;
  std::cout << "kind             cases  worst error  tolerance  verdict   worst at (case, field)\n";
  for (const auto& [kind, result] : results) {
    const bool compared = result.worst_share >= 0.0;
    std::cout << boost::format("%-17s%5d%13s%11s  %-9s %s\n") % kind % result.cases %
                     (compared ? scientific(result.worst_error, 1) : "-") %
                     (compared ? scientific(result.tolerance, 0) : "-") %
                     (result.problems.empty() ? "within" : "FAILED") % result.worst_place;
    for (const std::string& problem : result.problems) problems += kind + ": " + problem + "\n";
    if (!result.problems.empty()) failed += " " + kind;
  }
  for (const auto& known : kinds()) {
    if (results.count(known.first) > 0) continue;
    std::cout << known.first << ": no cases in this file, nothing compared\n";
  }
  std::cout << problems << std::flush;
  if (results.empty()) throw std::runtime_error("there are no cases");
  if (!failed.empty()) throw std::runtime_error("failed:" + failed);
  std::cout << "All cases are within their tolerances.\n";
}

/// @return false where --help was asked for and has been printed
bool parse(int argc, char** argv, std::string* path) {
  namespace po = boost::program_options;
  const po::options_description options(
      "Compares all cases of a file of reference values with what is computed here.\n\n"
      "usage: rosrun ddm_mpc pilco_check FILE.json\n\n"
      "Exit code 0: all within their tolerances; 1: the kinds that are not are named; 2: usage");
  return parseCommandLine(argc, argv, options, Positional{"file", po::value(path)->required(), 1});
}

}  // namespace
}  // namespace ddm::pilco::check

int main(int argc, char** argv) {
  namespace check = ddm::pilco::check;
  ddm::silenceSolverLog();
  std::string path;
  return ddm::runTool(
      "pilco_check", [&] { return check::parse(argc, argv, &path); },
      [&] { check::print(check::checkFile(path)); });
}
