// Training schedule: what is minimised over which parameters, one stage after the other.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/schedule.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
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
  return {{"joint", {true, {joint}, {}}},
          {"sequential", {true, {auto_encoder, predictor}, {}}},
          {"v_p_only", {true, {v_p_only}, {}}},
          {"v_r_only", {true, {auto_encoder}, {}}},
          {"joint_random_init", {false, {joint}, {}}}};
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
  for (const Named& named : schedules()) names.push_back(named.first);
  return names;
}

Schedule makeSchedule(const TrainingOptions& training) {
  const std::vector<Named> known = schedules();
  const auto named = std::find_if(known.begin(), known.end(),
                                  [&](const Named& one) { return one.first == training.schedule; });
  if (named == known.end()) {
    throw std::invalid_argument("unknown schedule '" + training.schedule + "': there are " +
                                boost::algorithm::join(scheduleNames(), ", "));
  }
  Schedule schedule = named->second;
  std::vector<Stage> stages;
  for (Stage stage : schedule.stages) {
    stage.terms.weight_decay = training.weight_decay;
    stage.max_iterations = training.max_iterations;
    if (stage.terms.v_p && training.prediction_steps > 1 && training.warm_up_iterations > 0) {
      stages.push_back(stage);
      stages.back().max_iterations = training.warm_up_iterations;
    }
    if (stage.terms.v_p) stage.terms.prediction_steps = training.prediction_steps;
    stages.push_back(stage);
  }
  const int rest = training.max_iterations - training.selection_iterations;
  if (training.selection_iterations > 0 && rest > 0) {
    schedule.finish = stages.back();
    schedule.finish->max_iterations = rest;
    stages.back().max_iterations = training.selection_iterations;
  }
  schedule.stages = stages;
  return schedule;
}

}  // namespace ddm
