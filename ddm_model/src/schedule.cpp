// Training schedule: the stages of a training, each with its terms and free parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/schedule.h"

#include <algorithm>
#include <map>

namespace ddm {
namespace {

/// @return terms and free parameters of each schedule, without weights and iterations
const std::map<std::string, Schedule>& schedules() {
  const Stage joint{{true, true}, Stage::Free::kAll};
  const Stage auto_encoder{{true, false}, Stage::Free::kAutoEncoder};
  const Stage predictor{{false, true}, Stage::Free::kPredictor};
  const Stage v_p_only{{false, true}, Stage::Free::kAll};
  static const std::map<std::string, Schedule> schedules = {
      {"joint", {true, {joint}}},
      {"sequential", {true, {auto_encoder, predictor}}},
      {"v_p_only", {true, {v_p_only}}},
      {"v_r_only", {true, {auto_encoder}}},
      {"joint_random_init", {false, {joint}}}};
  return schedules;
}

}  // namespace

Terms Schedule::terms() const {
  Terms all{false, false};
  for (const Stage& stage : stages) {
    all.v_r = all.v_r || stage.terms.v_r;
    all.v_p = all.v_p || stage.terms.v_p;
    all.prediction_steps = std::max(all.prediction_steps, stage.terms.prediction_steps);
    all.weight_decay = stage.terms.weight_decay;
  }
  return all;
}

std::vector<std::string> scheduleNames() {
  std::vector<std::string> names;
  for (const auto& schedule : schedules()) names.push_back(schedule.first);
  return names;
}

Schedule makeSchedule(const TrainingOptions& training) {
  Schedule schedule = schedules().at(training.schedule);
  for (Stage& stage : schedule.stages) {
    stage.terms.weight_decay = training.weight_decay;
    if (stage.terms.v_p) stage.terms.prediction_steps = training.prediction_steps;
    stage.max_iterations = training.max_iterations;
  }
  return schedule;
}

}  // namespace ddm
