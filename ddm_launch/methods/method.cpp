// Interface of a method, which learns from trials and acts in the next one.
// SPDX-License-Identifier: BSD-3-Clause
#include "method.h"

#include <algorithm>
#include <stdexcept>

#include "resolution.h"

namespace ddm {

std::vector<MethodKind> methodKinds() {
  const auto no_blocks = [](ParamReader*) { return YAML::Node(); };
  std::vector<MethodKind> kinds = {
      {"ddm", "the paper's (default)", no_blocks, makeDdmMethod},
      {"oracle", "plans with the same planner on the true plant and state", no_blocks,
       makeOracleMethod}};
#ifdef DDM_PILCO
  for (MethodKind& kind : pilcoMethods()) kinds.push_back(std::move(kind));
#endif
  return kinds;
}

MethodKind methodKind(const std::string& name) {
  std::string known;
  for (const MethodKind& kind : methodKinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + kind.name;
  }
  const std::vector<std::string> others = namesInGroup("method");
  if (std::count(others.begin(), others.end(), name) > 0) {
    throw std::invalid_argument(
        "method " + name + " is not in this build: build with -DDDM_PILCO=ON, there are " + known);
  }
  throw std::invalid_argument("unknown method '" + name + "': there are " + known);
}

Configuration readWithMethod(ParamReader* reader) {
  ParamReader ahead = *reader;  // a copy, so that problems of this block are not reported twice
  const std::string name = ahead.read<ExperimentOptions>("experiment").method;
  const YAML::Node blocks = methodKind(name).readBlocks(reader);
  Configuration configuration = readConfiguration(reader);
  configuration.method_blocks = blocks;
  return configuration;
}

}  // namespace ddm
