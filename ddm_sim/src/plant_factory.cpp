// Makes plants, and refuses those that describe themselves in a way that nothing can rely on.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_factory.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "ddm_sim/few_numbers.h"

namespace ddm {
namespace {

constexpr std::size_t kMaxDim = 1000;  // as in model files

std::vector<std::string> problemsOf(const PlantInfo& info) {
  std::vector<std::string> problems;
  const auto require = [&problems](bool ok, const std::string& rule, const auto& value) {
    if (ok) return;
    std::ostringstream problem;
    problem << rule << ", got " << value;
    problems.push_back(problem.str());
  };
  const auto quoted = [](const std::vector<std::string>& names) {
    return "\"" + boost::algorithm::join(names, ", ") + "\"";
  };
  const auto requireNames = [&](const std::string& what, const std::vector<std::string>& names) {
    require(!names.empty() && names.size() <= kMaxDim, what + " must be 1 to 1000 names",
            names.size());
    const bool usable = std::all_of(names.begin(), names.end(), usableName) &&
                        std::set<std::string>(names.begin(), names.end()).size() == names.size();
    require(usable, what + " must differ, and have neither blanks nor commas nor quotes",
            quoted(names));
  };
  const auto requireVector = [&](const std::string& what, const Eigen::VectorXd& values, int count,
                                 const char* rule, bool (*ok)(double)) {
    require(values.size() == count && values.allFinite(),
            what + " must be " + std::to_string(count) + " finite number(s)", fewNumbers(values));
    require(std::all_of(values.data(), values.data() + values.size(), ok), what + rule,
            fewNumbers(values));
  };
  const auto any = [](double) { return true; };
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  std::vector<std::string> joints;
  for (const Joint& joint : info.joints) joints.push_back(joint.name);
  requireNames("state_names", info.state_names);
  requireNames("torque_names", info.torque_names);
  requireNames("joints", joints);
  require(joints.size() <= info.state_names.size(),
          "joints must be at most one for each component of the state", quoted(joints));
  requireVector("max_torque", info.max_torque, info.torqueDim(), " must be > 0", positive);
  requireVector("start", info.start, info.stateDim(), "", any);
  requireVector("start_std", info.start_std, info.stateDim(), " must be >= 0",
                [](double x) { return x >= 0.0; });
  requireVector("goal", info.goal, info.stateDim(), "", any);
  require(positive(info.dt), "dt must be > 0 and finite", info.dt);
  require(positive(info.tolerance), "tolerance must be > 0 and finite", info.tolerance);
  require(usableName(info.error_unit), "error_unit must name the unit of the error",
          quoted({info.error_unit}));
  return problems;
}

}  // namespace

bool usableName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c > ' ' && c < 127 && c != ',' && c != '"';
  });
}

std::unique_ptr<Plant> makePlant(const PlantMaker& maker) {
  std::unique_ptr<Plant> plant = maker.make();
  const std::vector<std::string> problems =
      plant ? problemsOf(plant->info()) : std::vector<std::string>{"it must be made, got nothing"};
  if (problems.empty()) {
    plant->setType(maker.type());
    return plant;
  }
  throw std::invalid_argument("plant " + maker.type() + " breaks the rules of a plant:\n- " +
                              boost::algorithm::join(problems, "\n- ") +
                              "\nCorrect its class: doc/your_plant.md has the rules");
}

}  // namespace ddm
