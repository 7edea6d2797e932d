// Fuzz targets of ddm_launch: configurations and the CSV tables of a run folder.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>

#include <optional>

#include "configuration.h"
#include "tables.h"

using ddm::testing::accepts;
using ddm::testing::require;

namespace {

ddm::Configuration read(const ddm::testing::MemoryFile& file) {
  ddm::ParamReader reader = ddm::ParamReader::fromFiles({file.path()});
  return ddm::readConfiguration(&reader);
}

/// Fuzzes all blocks of the configuration of an experiment.
void configuration(const std::uint8_t* data, std::size_t size) {
  // A slash in plant/type would make the program search the whole workspace for plugins.
  if (std::find(data, data + size, '/') != data + size) return;
  static const ddm::testing::MemoryFile file;
  file.write(data, size);
  ddm::Configuration all;
  if (!accepts<std::invalid_argument>([&] { all = read(file); })) return;
  const std::string written = YAML::Dump(ddm::toYaml(all));
  file.write(written.data(), written.size());
  require(YAML::Dump(ddm::toYaml(read(file))) == written, "a saved configuration comes back");
}

/// Checks that a table is refused or survives writing and reading unchanged. The functions that
/// write tables refuse numbers that are not finite.
template <class Parse, class Format>
void checkTable(const std::string& text, const Parse& parse, const Format& format) {
  std::optional<decltype(parse(text))> read;
  if (!accepts<std::runtime_error>([&] { read = parse(text); })) return;
  const std::string written = format(*read);
  require(format(parse(written)) == written, "what is written is read");
}

/// Fuzzes torques.csv and trajectory.csv.
void runCsv(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  static const std::vector<std::string> torques = {"dx_px", "dy_px"}, states = {"x_px", "y_px"};
  checkTable(
      text,
      [](const std::string& table) { return ddm::parseTorquesCsv(table, torques, "torques.csv"); },
      [](const ddm::TorqueRows& rows) { return ddm::formatTorquesCsv(rows, torques); });
  checkTable(
      text,
      [](const std::string& table) {
        return ddm::parseTrajectoryCsv(table, states, "trajectory.csv");
      },
      [](const Eigen::MatrixXd& read) {
        std::vector<Eigen::VectorXd> columns;
        for (Eigen::Index i = 0; i < read.cols(); ++i) columns.push_back(read.col(i));
        return ddm::formatTrajectoryCsv(std::vector<double>(columns.size(), 0.2), columns, states);
      });
}

/// Fuzzes trials.csv.
void trialsCsv(const std::uint8_t* data, std::size_t size) {
  checkTable(
      std::string(reinterpret_cast<const char*>(data), size),
      [](const std::string& table) { return ddm::parseTrialsCsv(table, "trials.csv"); },
      ddm::formatTrialsCsv);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::FuzzTarget target = ddm::testing::chosenTarget(
      {{"configuration", configuration}, {"run_csv", runCsv}, {"trials_csv", trialsCsv}});
  target(data, size);
  return 0;
}
