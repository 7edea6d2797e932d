// Fuzz target: a configuration file, read into a block with each type of value.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>
#include <ddm_params/param_reader.h>

#include <algorithm>
#include <cmath>

using ddm::testing::accepts;
using ddm::testing::require;

namespace {

struct Options {
  int steps = 15;
  double weight = 0.01;
  bool residual = true;
  std::string topic = "torque";
  std::vector<int> widths = {60};
  std::vector<double> start = {0.0, 1.5};
  std::vector<std::string> names = {"a", "b"};

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("steps", steps);
    visitor("weight", weight);
    visitor("residual", residual);
    visitor("topic", topic);
    visitor("widths", widths);
    visitor("start", start);
    visitor("names", names);
  }
  std::vector<std::string> problems() const {
    const auto bad = [](double value) { return !std::isfinite(value); };
    if (!bad(weight) && std::none_of(start.begin(), start.end(), bad)) return {};
    return {"sim/weight and sim/start must be finite"};
  }
  bool operator==(const Options& other) const {
    return steps == other.steps && weight == other.weight && residual == other.residual &&
           topic == other.topic && widths == other.widths && start == other.start &&
           names == other.names;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::MemoryFile file;
  file.write(data, size);
  Options options;
  const auto read = [&] {
    // Some are merged with themselves.
    const std::vector<std::string> files(size % 4 == 0 ? 2 : 1, file.path());
    ddm::ParamReader reader = ddm::ParamReader::fromFiles(files);
    options = reader.read<Options>("sim");
    for (const std::string& problem : reader.problems()) {
      require(!problem.empty(), "a problem is told");
    }
    reader.requireValid();
  };
  if (!accepts<std::invalid_argument>(read)) return 0;

  YAML::Node root(YAML::NodeType::Map);
  root["sim"] = ddm::toYaml(options);
  const std::string text = YAML::Dump(root);
  file.write(text.data(), text.size());
  ddm::ParamReader saved = ddm::ParamReader::fromFiles({file.path()});
  require(saved.read<Options>("sim") == options, "a saved configuration comes back");
  saved.requireValid();
  return 0;
}
