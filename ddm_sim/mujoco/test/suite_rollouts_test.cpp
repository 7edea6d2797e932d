// Compares the plants suite_* with models of the DeepMind Control Suite: motion and rewards.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_plant_plugin/plant_config.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "ddm_sim/plant.h"

namespace ddm {
namespace {

constexpr char kRollouts[] = DDM_SIM_SOURCE_DIR "/mujoco/test/suite_rollouts/rollouts.csv";
constexpr double kStateBound = 1e-9;
constexpr double kRewardBound = 1e-6;

/// One control step of a trajectory. The README beside the file explains the columns.
using Row = std::map<std::string, std::string>;
using Trajectory = std::vector<Row>;

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  boost::split(cells, line, boost::is_any_of(","));
  return cells;
}

/// All trajectories of a task.
std::vector<Trajectory> trajectoriesOf(const std::string& task) {
  std::ifstream file(kRollouts);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> names = cellsOf(line);
  std::vector<Trajectory> out;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    Row row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = cells.at(i);
    if (row["task"] != task) continue;
    if (row["step"] == "0") out.emplace_back();
    out.back().push_back(row);
  }
  return out;
}

/// Values of the cells PREFIX_0 and PREFIX_1 for each prefix. Skips empty cells.
Eigen::VectorXd numbersOf(const Row& row, const std::vector<std::string>& prefixes) {
  std::vector<double> numbers;
  for (const std::string& prefix : prefixes) {
    for (const char* suffix : {"_0", "_1"}) {
      const std::string& cell = row.at(prefix + suffix);
      if (!cell.empty()) numbers.push_back(std::stod(cell));
    }
  }
  return Eigen::Map<Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

Eigen::VectorXd stateOf(const Row& row) { return numbersOf(row, {"qpos", "qvel"}); }

std::unique_ptr<Plant> plantOf(const std::string& name) {
  return makePlant(*readPlantFiles({DDM_SIM_SOURCE_DIR "/config/" + name + ".yaml"}));
}

/// A plant, its task in the file, and the column with its reward.
struct Case {
  std::string plant, task, reward;
};

const Case kCases[] = {{"suite_pendulum", "pendulum", "reward"},
                       {"suite_cartpole", "cartpole", "reward"},
                       {"suite_cartpole_balance", "cartpole", "reward"},
                       {"suite_reacher", "reacher", "reward"},
                       {"suite_acrobot", "acrobot", "reward"},
                       {"suite_reacher_hard", "reacher", "reward_variant"}};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.plant; }

class SuiteRolloutsTest : public ::testing::TestWithParam<Case> {};

TEST_P(SuiteRolloutsTest, MovesAndIsRewardedAsTheSuiteIs) {
  const auto plant = plantOf(GetParam().plant);
  const std::vector<Trajectory> trajectories = trajectoriesOf(GetParam().task);
  ASSERT_EQ(trajectories.size(), 2U);
  double rewarded = 0.0;
  for (const Trajectory& trajectory : trajectories) {
    ASSERT_GT(trajectory.size(), 100U);
    const std::string& x = trajectory.front().at("target_x_m");
    if (!x.empty()) {
      const double y = std::stod(trajectory.front().at("target_y_m"));
      plant->setGoal(plant->goalAt(Eigen::Vector2d(std::stod(x), y)));
    }
    plant->setState(stateOf(trajectory.front()));
    Eigen::VectorXd torque = Eigen::VectorXd::Zero(plant->torqueDim());
    for (std::size_t t = 0; t < trajectory.size(); ++t) {
      const Eigen::VectorXd state = stateOf(trajectory[t]);
      ASSERT_LE((plant->state() - state).lpNorm<Eigen::Infinity>(), kStateBound) << "step " << t;
      const double expected = std::stod(trajectory[t].at(GetParam().reward));
      ASSERT_NEAR(plant->reward(state, torque).value(), expected, kRewardBound) << "step " << t;
      rewarded += expected;
      if (t + 1 == trajectory.size()) break;
      torque = numbersOf(trajectory[t], {"effort"});
      // The file has the sum of this reward over the physics steps.
      if (GetParam().reward == "reward") {
        ASSERT_NEAR(plant->stepReward(state, torque).value(),
                    std::stod(trajectory[t].at("return_of_step")), kRewardBound)
            << "step " << t;
      }
      ASSERT_EQ(plant->step(torque), torque);
    }
  }
  EXPECT_GT(rewarded, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Tasks, SuiteRolloutsTest, ::testing::ValuesIn(kCases),
                         [](const auto& info) { return info.param.plant; });

TEST(SuitePlants, StartWithinTheRangesOfTheSuite) {
  struct Expected {
    const char* plant;
    Eigen::VectorXd middle, half_width;  // of the positions [rad, m]
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
    EXPECT_TRUE(least >= 0.05 - 1e-6 && least < 0.051) << name << " " << least;
    EXPECT_TRUE(most <= 0.20 + 1e-6 && most > 0.199) << name << " " << most;
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
