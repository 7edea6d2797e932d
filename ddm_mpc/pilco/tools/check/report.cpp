// pilco_check: all cases of a file, and what is told about them.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/report.h"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <set>
#include <sstream>
#include <stdexcept>

#include "check/kinds.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

YAML::Node load(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream content;
  content << file.rdbuf();
  std::string text = content.str();
  if (!file || text.empty()) throw std::runtime_error(path + ": cannot be read, or is empty");
  // JSON is YAML, but for tabs.
  std::replace(text.begin(), text.end(), '\t', ' ');
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsMap()) return root;
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(path + ": is not JSON: " + e.what());
  }
  throw std::runtime_error(path + ": must be an object with kinds of cases");
}

KindResult checkKind(const YAML::Node& cases, Check check) {
  KindResult result;
  std::set<std::string> ids;
  for (const YAML::Node& node : cases) {
    ++result.cases;
    const std::string name = "number " + std::to_string(result.cases);
    try {
      Case reference(node, name, &result);
      if (!ids.insert(reference.id()).second) reference.fail("id", "is there twice");
      if (!reference.has("id")) reference.fail("id", "is missing");
      check(&reference);
      reference.requireAllRead();
    } catch (const CaseError& e) {
      result.problems.push_back(e.what());
    } catch (const std::exception& e) {  // values that the library refuses
      const std::string id =
          node.IsMap() && node["id"] && node["id"].IsScalar() ? node["id"].Scalar() : name;
      result.problems.push_back("case " + id + ": " + e.what());
    }
  }
  return result;
}

void printRow(const std::string& kind, const KindResult& result, std::ostream* out) {
  std::ostringstream error, tolerance;
  if (result.worst_share >= 0.0) {
    error << std::scientific << std::setprecision(1) << result.worst_error;
    tolerance << std::scientific << std::setprecision(0) << result.tolerance;
  } else {
    error << "-";
    tolerance << "-";
  }
  *out << std::left << std::setw(17) << kind << std::right << std::setw(5) << result.cases
       << std::setw(13) << error.str() << std::setw(11) << tolerance.str() << "  " << std::left
       << std::setw(9) << (result.problems.empty() ? "within" : "FAILED") << " "
       << result.worst_place << "\n";
}

}  // namespace

bool Report::passed() const {
  if (kinds.empty() || !unknown.empty()) return false;
  return std::all_of(kinds.begin(), kinds.end(),
                     [](const auto& kind) { return kind.second.problems.empty(); });
}

Report checkFile(const std::string& path) {
  const YAML::Node root = load(path);
  Report report;
  for (const auto& item : root) {
    const std::string name = item.first.as<std::string>();
    if (name == "meta") continue;
    const auto known = kinds().find(name);
    if (known == kinds().end()) {
      report.unknown.push_back(name);
    } else if (report.kinds.count(name) > 0) {
      report.kinds[name].problems.push_back("the file has this kind twice");
    } else if (!item.second.IsSequence()) {
      report.kinds[name].problems.push_back("must be a list of cases");
    } else if (item.second.size() == 0) {
      report.kinds[name].problems.push_back("the list of cases is empty, nothing was compared");
    } else {
      report.kinds[name] = checkKind(item.second, known->second);
    }
  }
  for (const auto& known : kinds()) {
    if (report.kinds.count(known.first) == 0) report.without_cases.push_back(known.first);
  }
  return report;
}

void print(const Report& report, std::ostream* out) {
  *out << "kind             cases  worst error  tolerance  verdict   worst at (case, field)\n";
  for (const auto& kind : report.kinds) printRow(kind.first, kind.second, out);
  for (const std::string& kind : report.without_cases) {
    *out << kind << ": no cases in this file, nothing compared\n";
  }
  for (const auto& kind : report.kinds) {
    for (const auto& reported : kind.second.reported) {
      std::ostringstream error;
      error << std::scientific << std::setprecision(1) << reported.second;
      *out << kind.first << ": " << reported.first << ": worst " << error.str()
           << " (reported, not judged)\n";
    }
  }
  for (const auto& kind : report.kinds) {
    for (const std::string& problem : kind.second.problems) {
      *out << kind.first << ": " << problem << "\n";
    }
  }
  for (const std::string& kind : report.unknown) *out << kind << ": unknown kind, not compared\n";
  if (report.passed()) {
    *out << "All cases are within their tolerances.\n";
    return;
  }
  *out << "Failed:";
  for (const auto& kind : report.kinds) {
    if (!kind.second.problems.empty()) *out << " " << kind.first;
  }
  for (const std::string& kind : report.unknown) *out << " " << kind;
  *out << (report.kinds.empty() && report.unknown.empty() ? " there are no cases\n" : "\n");
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
