// Training schedule: what is minimised over which parameters, one stage after the other.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/schedule.h"

#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

using Named = std::pair<std::string, Schedule>;

std::vector<Named> schedules() {
  const Stage joint{{true, true}, Stage::Free::kAll};
  const Stage auto_encoder{{true, false}, Stage::Free::kAutoEncoder};
  const Stage predictor{{false, true}, Stage::Free::kPredictor};
  const Stage v_p_only{{false, true}, Stage::Free::kAll};
  return {{"joint", {true, {joint}}},
          {"sequential", {true, {auto_encoder, predictor}}},
          {"v_p_only", {true, {v_p_only}}},
          {"v_r_only", {true, {auto_encoder}}},
          {"joint_random_init", {false, {joint}}}};
}

}  // namespace

Terms Schedule::terms() const {
  Terms all{false, false};
  for (const Stage& stage : stages) {
    all.v_r = all.v_r || stage.terms.v_r;
    all.v_p = all.v_p || stage.terms.v_p;
  }
  return all;
}

std::vector<std::string> scheduleNames() {
  std::vector<std::string> names;
  for (const Named& named : schedules()) names.push_back(named.first);
  return names;
}

Schedule makeSchedule(const std::string& name) {
  std::string known;
  for (const Named& named : schedules()) {
    if (named.first == name) return named.second;
    known += (known.empty() ? "" : ", ") + named.first;
  }
  throw std::invalid_argument("unknown schedule '" + name + "': there are " + known);
}

}  // namespace ddm
