// Tests of the closed loop in one process: which goal the policy is shown.
// SPDX-License-Identifier: BSD-3-Clause
#include "closed_loop.h"

#include <ddm_sim/testing/toy_plant.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

namespace ddm {
namespace {

constexpr int kSize = 51;

/// Keeps the goals it is shown.
class Onlooker : public Policy {
 public:
  void startTrial(const TrialId& /*id*/) override {}
  void setGoal(const Grey& goal) override { goals.push_back(goal); }
  void observe(const Grey& /*grey*/) override {}
  Answer answer() override { return {Eigen::VectorXd::Zero(1), 0.0, {}}; }
  void apply(const Eigen::VectorXd& /*u*/) override {}

  std::vector<Grey> goals;
};

/// A cart whose goal is drawn with each start, and whose brightness shows where it is.
std::unique_ptr<Plant> cartWithAGoalPerTrial() {
  testing::ToyPlant::Traits traits;
  traits.draw_goal = [](std::mt19937_64* engine) -> Eigen::VectorXd {
    return Eigen::VectorXd::Unit(2, 0) * std::uniform_real_distribution<double>(0.0, 1.0)(*engine);
  };
  traits.draw = [](const Eigen::VectorXd& state) {
    return testing::plainPicture(kSize, static_cast<std::uint8_t>(255.0 * std::abs(state[0])));
  };
  return std::make_unique<testing::ToyPlant>(traits);
}

TEST(ClosedLoop, ShowsThePolicyTheGoalOfEachTrial) {
  Environment environment(cartWithAGoalPerTrial(), CameraOptions());
  const auto onlooker = std::make_shared<Onlooker>();
  EpsilonGreedy::Options greedy;
  greedy.epsilon = 0.0;
  std::vector<Grey> expected;
  for (std::uint32_t trial = 0; trial < 3; ++trial) {
    const TrialId id{7, trial, false};
    EpsilonGreedy policy(onlooker, greedy, id);
    runClosedLoop(&environment, &policy, id, kSize, 2, [](const ClosedLoopFrame& /*frame*/) {});
    expected.push_back(environment.goalImage().bytes);
  }
  EXPECT_EQ(onlooker->goals, expected);
  EXPECT_NE(expected[0], expected[1]);
  EXPECT_NE(expected[1], expected[2]);
}

}  // namespace
}  // namespace ddm
