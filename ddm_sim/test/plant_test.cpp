// Tests of the base class of plants: checks, saturation and initial states.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_common/random_stream.h"
#include "ddm_msgs/testing/not_finite.h"
#include "ddm_plant_plugin/testing/toy_plant.h"
#include "ddm_sim/pendulum.h"

namespace ddm {
namespace {

using testing::ToyPlant;
using Traits = ToyPlant::Traits;

std::unique_ptr<Plant> pendulum() { return std::make_unique<Pendulum>(PendulumOptions()); }

Eigen::VectorXd torque(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(Plant, RefusesStatesGoalsAndTorquesOfAnotherSizeOrNotFiniteAndKeepsTheOldOnes) {
  const auto plant = pendulum();
  const Eigen::Vector2d state(0.1 + 0.2, -1e-17);
  plant->setState(state);
  plant->setGoal(state);
  const std::vector<Eigen::VectorXd> bad_states = {
      Eigen::VectorXd::Zero(0), Eigen::VectorXd::Zero(3), Eigen::Vector2d(0.0, kNaN),
      Eigen::Vector2d(kInfinity, 0.0)};
  for (const Eigen::VectorXd& bad : bad_states) {
    EXPECT_THROW(plant->setState(bad), std::invalid_argument);
    EXPECT_THROW(plant->setGoal(bad), std::invalid_argument);
    EXPECT_THROW(plant->render(bad), std::invalid_argument);
    EXPECT_THROW(plant->goalError(bad), std::invalid_argument);
    EXPECT_THROW(plant->visiblePosition(bad), std::invalid_argument);
  }
  for (const Eigen::VectorXd& bad : {Eigen::VectorXd(), Eigen::VectorXd(Eigen::Vector2d::Zero()),
                                     torque(kNaN), torque(-kInfinity)}) {
    EXPECT_THROW(plant->step(bad), std::invalid_argument);
  }
  EXPECT_EQ(plant->state(), state);  // exactly, without rounding
  EXPECT_EQ(plant->goal(), state);
  EXPECT_THROW(plant->goalAt(Eigen::Vector2d(0.1, 0.1)), std::invalid_argument);
}

TEST(Plant, SaturatesEachMotorAtItsOwnLimitAndReturnsTheTorqueThatActed) {
  Traits traits;
  traits.info.torque_names = {"left_n", "right_n"};
  traits.info.max_torque = Eigen::Vector2d(1.0, 20.0);
  ToyPlant plant(traits);
  EXPECT_EQ(plant.step(Eigen::Vector2d(5.0, 5.0)), Eigen::Vector2d(1.0, 5.0));
  EXPECT_EQ(plant.step(Eigen::Vector2d(-0.5, -1e9)), Eigen::Vector2d(-0.5, -20.0));
}

TEST(Plant, ReportsANextStateThatIsNoneAndDoesNotMove) {
  const auto plant = pendulum();
  const Eigen::Vector2d state(1.7e308, 1.7e308);
  plant->setState(state);
  EXPECT_THROW(plant->step(torque(0.0)), std::range_error);
  EXPECT_EQ(plant->state(), state);
  Traits traits;
  traits.advance = [](const Eigen::VectorXd&, const Eigen::VectorXd&) {
    return Eigen::VectorXd(Eigen::VectorXd::Zero(1));
  };
  ToyPlant toy(traits);
  EXPECT_THROW(toy.step(torque(1.0)), std::logic_error);
  EXPECT_EQ(toy.state(), traits.info.start);
}

TEST(Plant, DrawsEachComponentOfAStartWithASpreadOfItsOwn) {
  Traits traits;
  traits.info.start << 3.0, -4.0;
  traits.info.start_std << 0.0, 0.5;
  std::mt19937_64 engine = randomStream({1, 0, false}, StreamRole::kStart);
  const Eigen::VectorXd start = ToyPlant(traits).drawStart(engine);
  EXPECT_EQ(start[0], 3.0);
  EXPECT_NE(start[1], -4.0);
}

TEST(Plant, IsRewardedAfterAStepUnderTheTorqueThatActed) {
  EXPECT_FALSE(pendulum()->reward(Eigen::Vector2d::Zero(), torque(1.0)));
  EXPECT_FALSE(pendulum()->stepReward(Eigen::Vector2d::Zero(), torque(1.0)));
  const ToyPlant plant(testing::colourfulToy());  // moves by 0.1 u
  const Eigen::Vector2d state(1.0, 2.0);
  EXPECT_DOUBLE_EQ(plant.stepReward(state, torque(2.0)).value(), -(1.44 + 4.84 + 0.4));
  EXPECT_EQ(plant.stepReward(state, torque(60.0)), plant.stepReward(state, torque(6.0)));
  const Eigen::VectorXd next = state.array() + 0.2;  // the state after this torque
  EXPECT_DOUBLE_EQ(
      plant.stepReward(state, torque(2.0), 2).value(),
      plant.stepReward(state, torque(2.0)).value() + plant.stepReward(next, torque(2.0)).value());
  EXPECT_THROW(plant.stepReward(state, Eigen::Vector2d::Zero()), std::invalid_argument);
}

TEST(Plant, RefusesAnImageThatIsNotWhatItsSizeSays) {
  const RenderedImage sound{3, 2, 3, std::vector<std::uint8_t>(18, 7),
                            std::vector<std::uint8_t>(6, 9)};
  RenderedImage few = sound, dim = sound, uncovered = sound, flat = sound, none;
  few.bytes.pop_back();
  dim.channels = 2;
  uncovered.cover.pop_back();
  flat.height = 0;
  Traits traits;
  for (const RenderedImage& rendered : {few, dim, uncovered, flat, none}) {
    traits.draw = [rendered](const Eigen::VectorXd&) { return rendered; };
    EXPECT_THROW(ToyPlant(traits).render(Eigen::Vector2d::Zero()), std::logic_error);
  }
  traits.draw = [sound](const Eigen::VectorXd&) { return sound; };
  EXPECT_EQ(ToyPlant(traits).render(Eigen::Vector2d::Zero()).bytes, sound.bytes);
}

TEST(MakePlant, RefusesWhatAPlantMayNotSayOfItself) {
  struct Flaw {
    std::function<void(PlantInfo*)> spoil;
    std::vector<std::string> words;
  };
  const Eigen::VectorXd three = Eigen::VectorXd::Ones(3);
  const std::vector<Flaw> flaws = {
      {[](auto* i) { i->state_names.pop_back(); }, {"start", "start_std", "goal", "1"}},
      {[](auto* i) { i->torque_names.clear(); }, {"torque_names"}},
      {[](auto* i) { i->torque_names.assign(1001, "n"); }, {"torque_names", "1001"}},
      {[](auto* i) { i->joints.clear(); }, {"joints"}},
      {[](auto* i) { i->state_names[0] = "angle,rad"; }, {"state_names", "angle,rad"}},
      {[](auto* i) { i->torque_names[0] = "torque\n"; }, {"torque_names"}},
      {[](auto* i) { i->state_names[1] = i->state_names[0]; }, {"state_names"}},
      {[](auto* i) { i->dt = 0.0; }, {"dt", "got 0"}},
      {[](auto* i) { i->max_torque[0] = 0.0; }, {"max_torque", "[0]"}},
      {[](auto* i) { i->max_torque[0] = kNaN; }, {"max_torque", "nan"}},
      {[](auto* i) { i->start[0] = kNaN; }, {"start", "nan"}},
      {[](auto* i) { i->start_std[1] = -0.1; }, {"start_std", "-0.1"}},
      {[&](auto* i) { i->goal = three; }, {"goal", "[1 1 1]"}},
      {[](auto* i) { i->tolerance = kNaN; }, {"tolerance", "nan"}},
      {[](auto* i) { i->error_unit = ""; }, {"error_unit"}},
      {[](auto* i) { i->dt = i->tolerance = 0.0, i->error_unit = ""; },  // all at once
       {"dt", "tolerance", "error_unit", "their_package/Toy", "doc/your_plant.md"}}};
  for (const Flaw& flaw : flaws) {
    Traits traits;
    flaw.spoil(&traits.info);
    EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
        [&traits] { makePlant(testing::ToyPlugin(traits)); }, flaw.words));
  }
  EXPECT_NO_THROW(makePlant(testing::ToyPlugin(Traits())));
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [] { checkedPlant(nullptr, "their_package/Toy"); }, {"their_package/Toy"}));
}

}  // namespace
}  // namespace ddm
