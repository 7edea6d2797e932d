// Checks the options of a plant with a MuJoCo model, independently of the model file.
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
  if (common.max_torque.empty()) common.max_torque = {1.0};  // the model file has the limits
  plant.add(common.problems());
  const auto each = [&plant](const std::vector<double>& numbers, const char* key, const char* rule,
                             bool (*ok)(double)) {
    for (const double number : numbers) plant.require(ok(number), key, rule, number);
  };
  const auto finite = [](double x) { return std::isfinite(x); };
  const auto requirePoint = [&](const char* key, const std::vector<double>& point) {
    plant.require(point.empty() || point.size() == 3, key, "be a point of three numbers",
                  std::to_string(point.size()) + " of them");
    each(point, key, "be finite", finite);
  };
  each(start, "start", "be finite", finite);
  each(start_uniform, "start_uniform", "be >= 0 and finite", isNotNegative);
  each(goal, "goal", "be finite", finite);
  each(goal_distance, "goal_distance", "be >= 0 and finite", isNotNegative);
  plant.require(goal_site.empty() == goal_distance.empty(), "goal_distance",
                "be given where plant/goal_site is", goal_distance.size());
  plant.require(
      goal_distance.empty() || (goal_distance.size() == 2 && goal_distance[0] <= goal_distance[1]),
      "goal_distance", "be the least and the largest distance", goal_distance.size());
  plant.requireNotNegative("timestep", timestep);
  plant.requirePositive("tolerance", tolerance);
  plant.requireWithin("episode_frames", episode_frames, 0, 10000000);
  std::vector<std::string> names;
  for (const Reward& one : rewards()) names.push_back(one.name);
  plant.require(reward.empty() || std::count(names.begin(), names.end(), reward) > 0, "reward",
                "be empty or one of those that there are",
                reward + ": " + suggestion(reward, names));
  requirePoint("camera_position", look.position);
  requirePoint("camera_look_at", look.look_at);
  plant.require(look.position.empty() == look.look_at.empty(), "camera_look_at",
                "be given where camera_position is",
                look.position.empty() ? "no position" : "no point to look at");
  plant.require(look.position.empty() || look.position != look.look_at, "camera_look_at",
                "differ from camera_position", "the same");
  plant.require(look.camera.empty() || look.position.empty(), "camera",
                "be left out where camera_position is given", look.camera);
  plant.requireWithin("supersampling", look.supersampling, 1, 8);
  // A larger image would need too much memory.
  constexpr int kMaxSize = 4096;
  plant.require(image_size * look.supersampling <= kMaxSize, "supersampling",
                "times image_size be at most " + std::to_string(kMaxSize) + " pixels",
                image_size * look.supersampling);
  return plant.problems();
}

}  // namespace ddm
