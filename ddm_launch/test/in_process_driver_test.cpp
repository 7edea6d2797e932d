// Tests of the in-process driver, in particular of trials and bags with lost images.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_driver.h"

#include <ddm_bag_io/bag_reader.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <ddm_sim/camera.h>
#include <ddm_sim/plant.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "method.h"
#include "toy_run.h"

namespace ddm {
namespace {

/// A plant whose state is the number of its steps. The state after step `last` is infinite.
testing::ToyPlant::Traits counter(int last) {
  testing::ToyPlant::Traits traits;
  traits.info.start = Eigen::VectorXd::Zero(1);
  traits.info.start_std = Eigen::VectorXd::Zero(1);
  traits.info.state_names = {"steps"};
  traits.info.goal = Eigen::VectorXd::Zero(1);
  traits.advance = [last](const Eigen::VectorXd& state, const Eigen::VectorXd& /*torque*/) {
    const double next = state[0] < last ? state[0] + 1.0 : std::numeric_limits<double>::infinity();
    return Eigen::VectorXd(Eigen::VectorXd::Constant(1, next));
  };
  return traits;
}

class InProcessDriverTest : public ::testing::Test {
 protected:
  InProcessDriverTest() : configuration_(testing::toyConfiguration("")) {
    request_.id = {7, 2, false};
    request_.num_steps = 40;
    request_.epsilon = 1.0;
    request_.bag = scratch_.file("trial.bag");
  }

  TrialOutcome run() {
    InProcessDriver driver(configuration_);
    return driver.runTrial(request_, [](double) {});
  }

  BagContent bag() const {
    return readBag(request_.bag, configuration_.model.image.size, configuration_.model.data_set);
  }

  /// Number of time steps from one image to the next.
  int stepsAfter(const TrialOutcome& outcome, size_t frame) const {
    const double steps =
        (outcome.times[frame + 1] - outcome.times[frame]) / configuration_.plant_info.dt;
    EXPECT_NEAR(steps, std::round(steps), 1e-6) << frame;
    return static_cast<int>(std::round(steps));
  }

  testing::TempFolder scratch_;
  Configuration configuration_;
  TrialRequest request_;
};

TEST_F(InProcessDriverTest, ThePlantStaysWhereTheLastFrameShowsItAsInLockStep) {
  testing::usePlant(testing::plantOf(counter(39)), &configuration_);
  const TrialOutcome outcome = run();
  ASSERT_EQ(outcome.states.size(), 40u);
  EXPECT_EQ(outcome.states.back()[0], 39.0);
}

TEST_F(InProcessDriverTest, ThePlantGoesOnUnderTheLastTorqueWhereAFrameIsLost) {
  configuration_.camera.drop_rate = 0.2;
  const TrialOutcome outcome = run();
  ASSERT_EQ(outcome.states.size(), 40u);  // num_steps counts images that were seen
  ASSERT_EQ(outcome.times.size(), 40u);
  ASSERT_EQ(outcome.torques.size(), 40u);
  EXPECT_EQ(outcome.times[0], 0.0);
  const auto plant = makePlant(*configuration_.plant);
  int num_lost = 0;
  for (size_t t = 0; t + 1 < 40; ++t) {
    const int steps = stepsAfter(outcome, t);
    num_lost += steps - 1;
    plant->setState(outcome.states[t]);
    for (int step = 0; step < steps; ++step) plant->step(outcome.torques[t]);
    EXPECT_EQ(plant->state(), outcome.states[t + 1]) << t;
  }
  EXPECT_GT(num_lost, 0);
}

TEST_F(InProcessDriverTest, NoPairOfTheBagStraddlesALostFrame) {
  configuration_.camera.drop_rate = 0.2;
  const TrialOutcome outcome = run();
  std::vector<Eigen::Index> expected = {0};  // first samples of the segments
  for (size_t t = 0; t + 1 < 40; ++t) {
    if (stepsAfter(outcome, t) > 1) expected.push_back(static_cast<Eigen::Index>(t) + 1);
  }
  ASSERT_GT(expected.size(), 3u);
  const BagContent content = bag();
  EXPECT_EQ(content.data.numFrames(), 40);
  std::vector<Eigen::Index> begins;
  for (const Segment& segment : content.data.segments()) begins.push_back(segment.begin);
  EXPECT_EQ(begins, expected);
}

TEST_F(InProcessDriverTest, FramesAndGoalAreThoseOfTheCameraInThisRun) {
  configuration_.camera.noise_std = 0.05;
  configuration_.camera.brightness_drift = 0.2;
  configuration_.camera.clutter = 0.6;
  configuration_.camera.delay = 2;
  configuration_.camera.drop_rate = 0.2;
  const TrialOutcome outcome = run();
  const BagContent content = bag();
  const auto plant = makePlant(*configuration_.plant);
  Camera camera(configuration_.camera, configuration_.plant_info.dt);
  const auto capture = [&] { return camera.capture(plant->render(plant->state())); };
  camera.begin({7, 2, false});
  EXPECT_EQ(content.data.goal(), camera.captureGoal(plant->render(plant->goal())).bytes);
  plant->setState(outcome.states[0]);
  for (Eigen::Index t = 0; t < 40; ++t) {
    auto captured = capture();
    while (!captured) {
      plant->step(outcome.torques[static_cast<size_t>(t) - 1]);
      captured = capture();
    }
    ASSERT_EQ(content.data.image(t), captured->bytes) << t;
    plant->step(outcome.torques[static_cast<size_t>(t)]);
  }
}

/// The grey level depends on the position, so that images show the position and the goal of the
/// cart.
testing::ToyPlant::Traits wandering() {
  testing::ToyPlant::Traits traits = testing::colourfulToy();
  traits.draw = [](const Eigen::VectorXd& state) {
    const double grey = 128.0 + 40.0 * state[0];
    return testing::plainImage(
        51, static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, grey)))));
  };
  return traits;
}

TEST_F(InProcessDriverTest, EachRunHasAGoalOfItsOwnInItsBagWhereThePlantDrawsOne) {
  testing::usePlant(testing::plantOf(wandering()), &configuration_);
  const auto plant = makePlant(*configuration_.plant);
  std::set<Image> goals;
  for (const std::uint32_t trial : {0U, 1U, 2U}) {
    request_.id.trial = trial;
    request_.bag = scratch_.file(std::to_string(trial) + ".bag");
    run();
    const Image expected = plant->render(goalOf(*plant, {7, trial, false})).bytes;
    EXPECT_EQ(bag().data.goal(), expected) << trial;
    goals.insert(expected);
  }
  EXPECT_EQ(goals.size(), 3u);
}

/// Records the goals that it receives.
class Onlooker : public Policy {
 public:
  void startTrial(const TrialId& /*id*/) override {}
  void setGoal(const Image& goal) override { goals.insert(goal); }
  void observe(const Image& /*grey*/) override {}
  Answer answer() override { return {Eigen::VectorXd::Zero(1), 0.0, {}}; }
  void apply(const Eigen::VectorXd& /*u*/) override {}

  std::set<Image> goals;
};

TEST_F(InProcessDriverTest, ShowsThePolicyTheGoalOfEachTrial) {
  testing::usePlant(testing::plantOf(wandering()), &configuration_);
  Environment environment(makePlant(*configuration_.plant), configuration_.camera);
  const auto onlooker = std::make_shared<Onlooker>();
  request_.epsilon = 0.0;
  std::set<Image> expected;
  for (request_.id.trial = 0; request_.id.trial < 3; ++request_.id.trial) {
    runClosedLoop(&environment, onlooker, request_, configuration_,
                  [](const auto&, const auto&) {});
    expected.insert(environment.goalImage().bytes);
  }
  EXPECT_EQ(onlooker->goals, expected);
  EXPECT_EQ(expected.size(), 3u);
}

TEST_F(InProcessDriverTest, APlantWithTwoMotorsIsDrivenByBoth) {
  testing::usePlant(testing::plantOf("{type: two_link}"), &configuration_);
  configuration_.mpc.max_torque = {2.0};
  const TrialOutcome outcome = run();
  ASSERT_EQ(outcome.torques.size(), 40u);
  double largest[2] = {0.0, 0.0};
  for (const Eigen::VectorXd& torque : outcome.torques) {
    ASSERT_EQ(torque.size(), 2);
    for (int i = 0; i < 2; ++i) largest[i] = std::max(largest[i], std::abs(torque[i]));
  }
  EXPECT_GT(largest[0], 1.0);
  EXPECT_GT(largest[1], 1.0);
  EXPECT_EQ(bag().data.torques().rows(), 2);
}

}  // namespace
}  // namespace ddm
