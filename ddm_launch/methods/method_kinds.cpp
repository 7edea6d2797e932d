// Which methods there are.
// SPDX-License-Identifier: BSD-3-Clause
#include "method_kinds.h"

#include <stdexcept>

#include "configuration.h"
#include "ddm_method.h"
#include "oracle_method.h"
#include "pilco/pilco_methods.h"
#include "resolution.h"

namespace ddm {
namespace {

/// A method that the common blocks suffice.
template <class AnyMethod>
class PlainSetup : public MethodSetup {
 public:
  YAML::Node blocks() const override { return YAML::Node(YAML::NodeType::Map); }
  std::unique_ptr<Method> make(const Configuration& configuration,
                               const Plant& plant) const override {
    return std::make_unique<AnyMethod>(configuration, plant);
  }
};

template <class AnyMethod>
MethodKind plainKind(const std::string& name, const std::string& about) {
  return {name, about, [](ParamReader*) { return std::make_shared<PlainSetup<AnyMethod>>(); }};
}

}  // namespace

std::vector<MethodKind> methodKinds() {
  std::vector<MethodKind> kinds = {
      plainKind<DdmMethod>("ddm", "the paper's (default)"),
      plainKind<OracleMethod>("oracle", "plans with the same planner on the true plant and state")};
  for (MethodKind& kind : pilcoMethods()) kinds.push_back(std::move(kind));
  return kinds;
}

MethodKind methodKind(const std::string& name) {
  std::string known;
  for (const MethodKind& kind : methodKinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + kind.name;
  }
  if (!methodFile(name).empty()) {
    throw std::invalid_argument(
        "method " + name + " is not in this build: build with -DDDM_PILCO=ON, there are " + known);
  }
  throw std::invalid_argument("unknown method '" + name + "': there are " + known);
}

}  // namespace ddm
