// Tests of the rules for plants, over all plants of this package and one of another package.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_reader.h>
#include <ddm_plant_plugin/plant_config.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "ddm_plant_plugin/testing/toy_plant.h"
#include "ddm_sim/plant.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::ToyPlugin;

struct Candidate {
  std::string name;
  std::function<std::shared_ptr<const PlantPlugin>()> maker;
  bool needs_mujoco = false;
  bool own = true;  ///< true for plants of this package
};

void PrintTo(const Candidate& candidate, std::ostream* out) { *out << candidate.name; }

std::shared_ptr<const PlantPlugin> makerOfFile(const std::string& path) {
  ParamReader reader = ParamReader::fromFiles({path});
  std::shared_ptr<const PlantPlugin> maker = readPlant(&reader);
  reader.requireValid();
  return maker;
}

/// All plants that the folder config/ describes, toy plants with further features, and the plant
/// that the environment variable DDM_PLANT names, such as ddm_cart/cart.
std::vector<Candidate> candidates() {
  std::vector<Candidate> out;
  for (const fs::directory_entry& entry : fs::directory_iterator(DDM_SIM_SOURCE_DIR "/config")) {
    const std::string path = entry.path().string();
    const std::string name = entry.path().stem().string();
    if (name == "sim" || name == "robot") continue;  // these files describe no plants
    const YAML::Node type = YAML::LoadFile(path)["plant"]["type"];
    out.push_back(
        {name, [path] { return makerOfFile(path); }, type.as<std::string>("") == "mujoco"});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  out.push_back({"toy", [] { return std::make_shared<ToyPlugin>(testing::colourfulToy()); }});
  if (const char* const named = std::getenv("DDM_PLANT")) {
    out.push_back({"named", [named] { return makerOfFile(plantFile(named)); }, false, false});
  }
  return out;
}

class EveryPlantTest : public ::testing::TestWithParam<Candidate> {
 protected:
  void SetUp() override {
    if (!DDM_HAS_MUJOCO && GetParam().needs_mujoco) {
      GTEST_SKIP() << "ddm_sim was built without MuJoCo";
    }
    maker_ = GetParam().maker();
    plant_ = makePlant(*maker_);
  }

  const PlantInfo& info() const { return plant_->info(); }

  /// States of a plant under random torques, and its initial state and goal.
  std::vector<Eigen::VectorXd> states() const {
    const std::unique_ptr<Plant> plant = makePlant(*maker_);
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<Eigen::VectorXd> out = {info().start, info().goal, plant->drawGoal(engine),
                                        plant->drawStart(engine)};
    plant->setState(out.back());
    for (int t = 0; t < 50; ++t) {
      const auto share = [&](double limit) { return limit * uniform(engine); };
      plant->step(info().max_torque.unaryExpr(share));
      out.push_back(plant->state());
    }
    return out;
  }

  std::shared_ptr<const PlantPlugin> maker_;
  std::unique_ptr<Plant> plant_;
};

TEST_P(EveryPlantTest, IsMadeInTheMiddleOfItsStartsAndMovesUnderEachMotor) {
  EXPECT_EQ(plant_->state(), info().start);
  EXPECT_EQ(plant_->goal(), info().goal);
  if (GetParam().own) {
    plant_->step(Eigen::VectorXd::Zero(plant_->torqueDim()));
    // sin(pi) is 1e-16 in double precision, and some plants hang at pi.
    EXPECT_LE((plant_->state() - info().start).lpNorm<Eigen::Infinity>(), 1e-12);
  }
  for (Eigen::Index motor = 0; motor < plant_->torqueDim(); ++motor) {
    plant_->setState(info().start);
    plant_->step(info().max_torque[motor] * Eigen::VectorXd::Unit(plant_->torqueDim(), motor));
    EXPECT_NE(plant_->state(), info().start) << motor;
  }
}

TEST_P(EveryPlantTest, HasAnErrorAnImageAPlaceAndARewardInEachState) {
  EXPECT_LE(plant_->goalError(info().goal), 1e-9 * info().tolerance);
  if (info().start != info().goal) {  // in a balancing task, the initial state is the goal
    EXPECT_GT(plant_->goalError(info().start), info().tolerance);
  }
  const RenderedImage first = plant_->render(info().start);
  const Eigen::Index num_places = plant_->visiblePosition(info().start).size();
  const bool has_reward = plant_->reward(info().start, info().max_torque).has_value();
  EXPECT_GE(num_places, 1);
  for (const Eigen::VectorXd& state : states()) {
    const double error = plant_->goalError(state);
    ASSERT_TRUE(error >= 0.0 && std::isfinite(error)) << state.transpose();
    plant_->setGoal(state);  // goalError() refers to the goal of the episode
    ASSERT_LE(plant_->goalError(state), 1e-9 * info().tolerance) << state.transpose();
    plant_->setGoal(info().goal);
    const Eigen::VectorXd place = plant_->visiblePosition(state);
    ASSERT_TRUE(place.size() == num_places && place.allFinite()) << state.transpose();
    for (const auto& reward : {plant_->reward(state, -info().max_torque),
                               plant_->stepReward(state, -info().max_torque)}) {
      ASSERT_EQ(reward.has_value(), has_reward);
      ASSERT_TRUE(std::isfinite(reward.value_or(0.0)));
    }
    const RenderedImage rendered = plant_->render(state);
    ASSERT_EQ(rendered.width, first.width);
    ASSERT_EQ(rendered.height, first.height);
    ASSERT_EQ(rendered.channels, first.channels);
    // Images of a model file have their own background and no cover. Other images of this package
    // have a cover, see camera/clutter.
    if (GetParam().own) {
      ASSERT_EQ(rendered.cover.empty(), maker_->type() == "mujoco");
    }
    for (std::size_t i = 0; !rendered.cover.empty() && i < rendered.bytes.size(); ++i) {
      const std::size_t pixel = i / static_cast<std::size_t>(rendered.channels);
      ASSERT_GE(rendered.cover[pixel], rendered.bytes[i]) << pixel;
    }
  }
}

TEST_P(EveryPlantTest, DrawsAStartAndAGoalThatTheRunFixesAndDoesNotSetThem) {
  for (const bool evaluation : {false, true}) {
    std::mt19937_64 first = randomStream({7, 3, evaluation}, StreamRole::kStart), second = first;
    std::mt19937_64 other = randomStream({7, 4, evaluation}, StreamRole::kStart);
    const std::unique_ptr<Plant> twin = makePlant(*maker_);
    const Eigen::VectorXd start = plant_->drawStart(first);
    EXPECT_EQ(twin->drawStart(second), start);
    EXPECT_NE(plant_->drawStart(other), start);
    const Eigen::VectorXd goal = goalOf(*plant_, {7, 3, evaluation});
    EXPECT_EQ(goalOf(*twin, {7, 3, evaluation}), goal);
    twin->setGoal(goal);
    EXPECT_LE(twin->goalError(goal), 1e-9 * info().tolerance);
  }
  EXPECT_EQ(plant_->state(), info().start);
  EXPECT_EQ(plant_->goal(), info().goal);
}

TEST_P(EveryPlantTest, SpreadsItsStartsAsItSays) {
  std::mt19937_64 engine = randomStream({1, 0, false}, StreamRole::kStart);
  constexpr int kDraws = 20000;
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(plant_->stateDim());
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(plant_->stateDim(), plant_->stateDim());
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd offset = plant_->drawStart(engine) - info().start;
    sum += offset.array();
    products += offset * offset.transpose();
  }
  for (Eigen::Index i = 0; i < plant_->stateDim(); ++i) {
    // Tolerances are five standard errors: 1 / sqrt(n) for mean and correlation, 1 / sqrt(2 n) for
    // the deviation.
    const double spread = info().start_std[i];
    EXPECT_NEAR(sum[i] / kDraws, 0.0, 5 * spread / std::sqrt(kDraws)) << i;
    EXPECT_NEAR(std::sqrt(products(i, i) / kDraws), spread, 5 * spread / std::sqrt(2.0 * kDraws));
    for (Eigen::Index j = 0; j < i; ++j) {
      EXPECT_NEAR(products(i, j) / kDraws, 0.0,
                  5 * spread * info().start_std[j] / std::sqrt(kDraws));
    }
  }
}

TEST_P(EveryPlantTest, RemembersNothingButItsStateAndGoal) {
  const std::vector<Eigen::VectorXd> way = states();
  EXPECT_EQ(states(), way);
  const std::unique_ptr<Plant> fresh = makePlant(*maker_);
  for (const Eigen::VectorXd& state : {way[3], way[40], way[7]}) {
    plant_->setState(state);
    plant_->step(info().max_torque);
    fresh->setState(info().goal);
    fresh->step(-info().max_torque);
    fresh->setState(state);
    fresh->step(info().max_torque);
    EXPECT_EQ(plant_->state(), fresh->state());
    EXPECT_EQ(plant_->render(state).bytes, fresh->render(state).bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryPlantTest, ::testing::ValuesIn(candidates()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace ddm
