// A plant that a model file describes: what values are valid, whatever the file.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_options.h"

#include <algorithm>
#include <cmath>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/rewards.h"

namespace ddm {

std::vector<std::string> MujocoOptions::problems() const {
  OptionChecks plant("plant");
  PlantOptions common = *this;
  if (common.max_torque.empty()) common.max_torque = {1.0};  // the file knows
  plant.add(common.problems());
  const auto each = [&plant](const std::vector<double>& numbers, const char* key, const char* rule,
                             bool (*ok)(double)) {
    for (const double number : numbers) plant.require(ok(number), key, rule, number);
  };
  const auto finite = [](double x) { return std::isfinite(x); };
  each(start, "start", "be finite", finite);
  each(start_uniform, "start_uniform", "be >= 0 and finite", isNotNegative);
  each(goal, "goal", "be finite", finite);
  each(goal_distance, "goal_distance", "be >= 0 and finite", isNotNegative);
  plant.require(goal_site.empty() == goal_distance.empty(), "goal_distance",
                "be given where plant/goal_site is", goal_distance.size());
  plant.require(
      goal_distance.empty() || (goal_distance.size() == 2 && goal_distance[0] <= goal_distance[1]),
      "goal_distance", "be the least and the largest distance", goal_distance.size());
  plant.require(error_joints.empty() || error_sites.empty(), "error_sites",
                "be left out where plant/error_joints is given", error_sites.size());
  plant.require(isNotNegative(timestep), "timestep", "be >= 0 and finite [s]", timestep);
  plant.require(isPositive(tolerance), "tolerance", "be given, > 0 and finite [deg, or m]",
                tolerance);
  plant.require(episode_frames >= 0 && episode_frames <= 10000000, "episode_frames",
                "lie in [0, 10000000]", episode_frames);
  std::vector<std::string> names;
  for (const Reward& one : rewards()) names.push_back(one.name);
  plant.require(reward.empty() || std::count(names.begin(), names.end(), reward) > 0, "reward",
                "be empty or one of those that there are",
                reward + ": " + suggestion(reward, names));
  RenderOptions picture = look;
  picture.width = picture.height = picture_size;
  plant.add(picture.problems("plant"));
  plant.add(scene.problems("plant"));
  return plant.problems();
}

}  // namespace ddm
