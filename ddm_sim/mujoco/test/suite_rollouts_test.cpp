// Plants suite_*: they move, and are rewarded, as the DeepMind Control Suite's own model files do.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_reader.h>
#include <ddm_plant_plugin/plant_config.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_sim/plant.h"

namespace ddm {
namespace {

constexpr char kRollouts[] = DDM_SIM_SOURCE_DIR "/mujoco/test/suite_rollouts/rollouts.csv";
constexpr double kStateBound = 1e-9;
constexpr double kRewardBound = 1e-6;

/// A control step of a trajectory; see the README beside the file.
using Row = std::map<std::string, std::string>;
using Trajectory = std::vector<Row>;

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line + ",");
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

/// Trajectories of a task, one after the other.
std::vector<Trajectory> trajectoriesOf(const std::string& task) {
  std::ifstream file(kRollouts);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = cellsOf(line);
  std::vector<Trajectory> out;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    if (cells.size() != names.size()) throw std::runtime_error("another number of cells: " + line);
    Row row;
    for (std::size_t i = 0; i < cells.size(); ++i) row[names[i]] = cells[i];
    if (row["task"] != task) continue;
    if (row["step"] == "0") out.emplace_back();
    out.back().push_back(row);
  }
  return out;
}

/// The cells PREFIX_0, PREFIX_1, ... that are not empty.
Eigen::VectorXd numbersOf(const Row& row, const std::string& prefix) {
  std::vector<double> numbers;
  for (const char* suffix : {"_0", "_1"}) {
    const std::string& cell = row.at(prefix + suffix);
    if (!cell.empty()) numbers.push_back(std::stod(cell));
  }
  return Eigen::Map<Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

Eigen::VectorXd stateOf(const Row& row) {
  const Eigen::VectorXd positions = numbersOf(row, "qpos");
  Eigen::VectorXd state(2 * positions.size());
  state << positions, numbersOf(row, "qvel");
  return state;
}

std::unique_ptr<Plant> plantOf(const std::string& name) {
  ParamReader reader = ParamReader::fromFiles({DDM_SIM_SOURCE_DIR "/config/" + name + ".yaml"});
  const auto maker = readPlant(&reader);
  reader.requireValid();
  return makePlant(*maker);
}

/// A plant, the task it is, and the column of its reward.
struct Case {
  std::string plant, task, reward;
};

void PrintTo(const Case& tested, std::ostream* out) {
  *out << tested.plant << " " << tested.reward;
}

class SuiteRolloutsTest : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    plant_ = plantOf(GetParam().plant);
    trajectories_ = trajectoriesOf(GetParam().task);
    ASSERT_EQ(trajectories_.size(), 2U);
    for (const Trajectory& trajectory : trajectories_) ASSERT_GT(trajectory.size(), 100U);
  }

  /// Takes the start, and the target where there is one.
  void begin(const Trajectory& trajectory) {
    plant_->setState(stateOf(trajectory.front()));
    const std::string& x = trajectory.front().at("target_x_m");
    if (x.empty()) return;
    const Eigen::Vector2d target(std::stod(x), std::stod(trajectory.front().at("target_y_m")));
    plant_->setGoal(plant_->goalAt(target));
  }

  std::unique_ptr<Plant> plant_;
  std::vector<Trajectory> trajectories_;
};

TEST_P(SuiteRolloutsTest, MovesAsTheSuiteDoesFromItsStartOn) {
  for (const Trajectory& trajectory : trajectories_) {
    begin(trajectory);
    for (std::size_t t = 0; t + 1 < trajectory.size(); ++t) {
      const Eigen::VectorXd torque = numbersOf(trajectory[t], "effort");
      ASSERT_EQ(plant_->step(torque), torque);
      const Eigen::VectorXd off = plant_->state() - stateOf(trajectory[t + 1]);
      ASSERT_LE(off.lpNorm<Eigen::Infinity>(), kStateBound) << "step " << t + 1;
    }
  }
}

TEST_P(SuiteRolloutsTest, IsRewardedAsTheSuiteDoes) {
  double sum = 0.0;
  for (const Trajectory& trajectory : trajectories_) {
    begin(trajectory);
    for (std::size_t t = 0; t < trajectory.size(); ++t) {
      // The start itself counts as reached without a torque.
      const Eigen::VectorXd torque = t > 0 ? numbersOf(trajectory[t - 1], "effort")
                                           : Eigen::VectorXd::Zero(plant_->torqueDim());
      const double expected = std::stod(trajectory[t].at(GetParam().reward));
      const std::optional<double> reward = plant_->reward(stateOf(trajectory[t]), torque);
      ASSERT_TRUE(reward.has_value());
      ASSERT_NEAR(*reward, expected, kRewardBound) << "step " << t;
      sum += expected;
    }
  }
  EXPECT_GT(sum, 0.0) << "nothing is rewarded here";
}

/// The plants whose reward is that which `return_of_step` sums.
class SuiteReturnsTest : public SuiteRolloutsTest {};

TEST_P(SuiteReturnsTest, AddsTheRewardsOfThePhysicsFramesOfAStep) {
  for (const Trajectory& trajectory : trajectories_) {
    begin(trajectory);
    for (std::size_t t = 0; t + 1 < trajectory.size(); ++t) {
      const auto sum =
          plant_->stepReward(stateOf(trajectory[t]), numbersOf(trajectory[t], "effort"));
      ASSERT_TRUE(sum.has_value());
      ASSERT_NEAR(*sum, std::stod(trajectory[t].at("return_of_step")), kRewardBound)
          << "step " << t;
    }
  }
}

std::vector<Case> returnCases() {
  return {{"suite_pendulum", "pendulum", "reward"},
          {"suite_cartpole", "cartpole", "reward"},
          {"suite_cartpole_balance", "cartpole", "reward"},
          {"suite_reacher", "reacher", "reward"},
          {"suite_acrobot", "acrobot", "reward"}};
}

std::vector<Case> allCases() {
  std::vector<Case> cases = returnCases();
  cases.push_back({"suite_reacher_hard", "reacher", "reward_variant"});
  return cases;
}

std::string taskName(const ::testing::TestParamInfo<Case>& info) {
  return info.param.plant + "_" + info.param.reward;
}

INSTANTIATE_TEST_SUITE_P(Tasks, SuiteRolloutsTest, ::testing::ValuesIn(allCases()), taskName);
INSTANTIATE_TEST_SUITE_P(Tasks, SuiteReturnsTest, ::testing::ValuesIn(returnCases()), taskName);

TEST(SuitePlants, StartWithinTheRangesOfTheSuite) {
  struct Expected {
    const char* plant;
    Eigen::VectorXd middle, half_width;  // of positions [rad, m]
  };
  const auto two = [](double a, double b) { return Eigen::VectorXd(Eigen::Vector2d(a, b)); };
  const double pi = 3.14159265358979312;
  for (const Expected& expected :
       {Expected{"suite_pendulum", Eigen::VectorXd::Constant(1, pi),
                 Eigen::VectorXd::Constant(1, pi)},
        Expected{"suite_cartpole_balance", two(0.0, 0.0), two(0.1, 0.034)},
        Expected{"suite_reacher", two(0.0, 0.0), two(pi, 160.0 / 180.0 * pi)},
        Expected{"suite_acrobot", two(pi, 0.0), two(pi, pi)}}) {
    const auto plant = plantOf(expected.plant);
    std::mt19937_64 engine(1);
    const Eigen::Index joints = expected.middle.size();
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(joints);
    for (int i = 0; i < 1000; ++i) {
      const Eigen::VectorXd offset = plant->drawStart(engine).head(joints) - expected.middle;
      largest = largest.cwiseMax(offset.cwiseAbs());
    }
    for (Eigen::Index i = 0; i < joints; ++i) {
      EXPECT_LE(largest[i], expected.half_width[i] * (1.0 + 1e-12)) << expected.plant << " " << i;
      EXPECT_GT(largest[i], 0.95 * expected.half_width[i]) << expected.plant << " " << i;
    }
  }
}

TEST(SuitePlants, TheReacherDrawsTargetsWhereTheSuiteDoes) {
  for (const char* name : {"suite_reacher", "suite_reacher_hard"}) {
    const auto plant = plantOf(name);
    std::mt19937_64 engine(1);
    double least = 1.0, most = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::VectorXd goal = plant->drawGoal(engine);
      const double x = 0.12 * (std::cos(goal[0]) + std::cos(goal[0] + goal[1]));
      const double y = 0.12 * (std::sin(goal[0]) + std::sin(goal[0] + goal[1]));
      least = std::min(least, std::hypot(x, y));
      most = std::max(most, std::hypot(x, y));
    }
    EXPECT_NEAR(least, 0.05, 1e-3) << name;
    EXPECT_NEAR(most, 0.20, 1e-3) << name;
    EXPECT_GE(least, 0.05 - 1e-6) << name;
    EXPECT_LE(most, 0.20 + 1e-6) << name;
  }
}

TEST(MujocoPendulum, MovesAsTheClosedFormOfThePendulumDoes) {
  const auto model = plantOf("mujoco_pendulum");
  const auto exact = plantOf("pendulum");
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (int trial = 0; trial < 5; ++trial) {
    model->setState(exact->drawStart(engine));
    exact->setState(model->state());
    for (int t = 0; t < 100; ++t) {
      const Eigen::VectorXd torque = exact->info().max_torque * (trial == 0 ? 1.0 : share(engine));
      EXPECT_EQ(model->step(torque), exact->step(torque));
      ASSERT_LE((model->state() - exact->state()).lpNorm<Eigen::Infinity>(), 1e-7) << t;
    }
  }
}

}  // namespace
}  // namespace ddm
