// Fuzz target: trials.csv of a run folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "trials_csv.h"

#include <ddm_msgs/testing/fuzzing.h>

#include <cmath>

using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::vector<ddm::TrialRow> rows;
  const auto read = [&] { rows = ddm::parseTrialsCsv(text, "trials.csv"); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return 0;
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
  return 0;
}
