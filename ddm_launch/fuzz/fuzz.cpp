// Fuzz targets of ddm_launch: configurations, and the tables of a run folder.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>

#include <cmath>

#include "configuration.h"
#include "run_csv.h"
#include "trials_csv.h"

using ddm::testing::accepts;
using ddm::testing::require;

namespace {

ddm::Configuration read(const ddm::testing::MemoryFile& file) {
  ddm::ParamReader reader = ddm::ParamReader::fromFiles({file.path()});
  return ddm::readConfiguration(&reader);
}

/// The configuration of an experiment, all its blocks.
void configuration(const std::uint8_t* data, std::size_t size) {
  // A slash in plant/type would look for plugins in all of the workspace.
  if (std::find(data, data + size, '/') != data + size) return;
  static const ddm::testing::MemoryFile file;
  file.write(data, size);
  ddm::Configuration all;
  if (!accepts<std::invalid_argument>([&] { all = read(file); })) return;
  const std::string written = YAML::Dump(ddm::toYaml(all));
  file.write(written.data(), written.size());
  require(YAML::Dump(ddm::toYaml(read(file))) == written, "a saved configuration comes back");
}

void checkTorques(const std::string& text) {
  static const std::vector<std::string> names = {"dx_px", "dy_px"};
  ddm::TorqueRows rows;
  const auto read = [&] { rows = ddm::parseTorquesCsv(text, names, "torques.csv"); };
  if (!accepts<std::runtime_error>(read)) return;
  require(rows.torques.size() == rows.exploratory.size(), "each torque is exploratory or not");
  for (const Eigen::VectorXd& torque : rows.torques) {
    require(torque.size() == 2 && torque.allFinite(), "torques are finite");
  }
  const ddm::TorqueRows again =
      ddm::parseTorquesCsv(ddm::formatTorquesCsv(rows, names), names, "torques.csv");
  require(again.torques == rows.torques && again.exploratory == rows.exploratory,
          "torques come back digit by digit");
}

void checkTrajectory(const std::string& text) {
  static const std::vector<std::string> names = {"x_px", "y_px"};
  Eigen::MatrixXd states;
  const auto read = [&] { states = ddm::parseTrajectoryCsv(text, names, "trajectory.csv"); };
  if (!accepts<std::runtime_error>(read)) return;
  require(states.rows() == 2 && states.allFinite(), "states are finite");
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index i = 0; i < states.cols(); ++i) columns.push_back(states.col(i));
  const std::string written =
      ddm::formatTrajectoryCsv(std::vector<double>(columns.size(), 0.2), columns, names);
  require(ddm::parseTrajectoryCsv(written, names, "trajectory.csv") == states,
          "states come back digit by digit");
}

/// torques.csv and trajectory.csv.
void runCsv(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  checkTorques(text);
  checkTrajectory(text);
}

/// trials.csv of a run folder.
void trialsCsv(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::vector<ddm::TrialRow> rows;
  const auto read = [&] { rows = ddm::parseTrialsCsv(text, "trials.csv"); };
  if (!accepts<std::runtime_error>(read)) return;
  for (const ddm::TrialRow& row : rows) {
    require(std::isfinite(row.train_s) && row.train_s >= 0.0, "a training takes time");
    require(std::isfinite(row.v_r.value_or(0.0)) && std::isfinite(row.v_p.value_or(0.0)),
            "V_R and V_P are finite");
    require(row.v_r.has_value() == row.v_p.has_value(), "errors come in pairs");
    require(std::isfinite(row.evaluation.final_error.value_or(0.0)), "errors are finite");
    require(std::isfinite(row.evaluation.total_reward.value_or(0.0)), "returns are finite");
  }
  const std::string written = ddm::formatTrialsCsv(rows);
  require(ddm::formatTrialsCsv(ddm::parseTrialsCsv(written, "trials.csv")) == written,
          "what is written is read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::FuzzTarget target = ddm::testing::chosenTarget(
      {{"configuration", configuration}, {"run_csv", runCsv}, {"trials_csv", trialsCsv}});
  target(data, size);
  return 0;
}
