// Tests of the world in one process: what a camera that loses frames does to a trial and its bag.
// SPDX-License-Identifier: BSD-3-Clause
#include "in_process_world.h"

#include <ddm_bag_io/bag_reader.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <ddm_sim/camera.h>
#include <ddm_sim/plant_factory.h>
#include <ddm_sim/testing/toy_plant.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "toy_run.h"

namespace ddm {
namespace {

/// A plant whose state is the number of its steps, and which has none beyond the last.
testing::ToyPlant::Traits counter(int last) {
  testing::ToyPlant::Traits traits;
  traits.start = Eigen::VectorXd::Zero(1);
  traits.start_std = 0.0;
  traits.states = {"steps"};
  traits.goal = Eigen::VectorXd::Zero(1);
  traits.advance = [last](const Eigen::VectorXd& state, const Eigen::VectorXd& /*torque*/) {
    const double next = state[0] < last ? state[0] + 1.0 : std::numeric_limits<double>::infinity();
    return Eigen::VectorXd(Eigen::VectorXd::Constant(1, next));
  };
  return traits;
}

class InProcessWorldTest : public ::testing::Test {
 protected:
  InProcessWorldTest() : configuration_(testing::toyConfiguration("")) {
    ParamReader reader{YAML::Node(YAML::NodeType::Map)};
    configuration_.method = methodKind("ddm").read(&reader);
    request_.id = {7, 2, false};
    request_.num_steps = 40;
    request_.epsilon = 1.0;
    request_.bag = scratch_.file("trial.bag");
  }

  TrialOutcome run() {
    InProcessWorld world(configuration_);
    return world.runTrial(request_, [](double) {});
  }

  BagContent bag() const {
    return readBag(request_.bag, configuration_.model.image.size, configuration_.model.data_set);
  }

  /// Time steps from one frame to the next.
  int stepsAfter(const TrialOutcome& outcome, size_t frame) const {
    const double steps =
        (outcome.times[frame + 1] - outcome.times[frame]) / configuration_.plant.dt;
    EXPECT_NEAR(steps, std::round(steps), 1e-6) << frame;
    return static_cast<int>(std::round(steps));
  }

  testing::TempFolder scratch_;
  Configuration configuration_;
  TrialRequest request_;
};

TEST_F(InProcessWorldTest, APerfectCameraGivesAFrameInEachStepAndOnePiece) {
  const TrialOutcome outcome = run();
  ASSERT_EQ(outcome.times.size(), 40u);
  for (size_t t = 0; t + 1 < 40; ++t) EXPECT_EQ(stepsAfter(outcome, t), 1) << t;
  ASSERT_EQ(bag().data.pieces().size(), 1u);
  EXPECT_EQ(bag().data.numFrames(), 40);
}

TEST_F(InProcessWorldTest, ThePlantStaysWhereTheLastFrameShowsItAsInLockStep) {
  configuration_.plant = testing::toyOptions(counter(39));
  const TrialOutcome outcome = run();
  ASSERT_EQ(outcome.states.size(), 40u);
  EXPECT_EQ(outcome.states.back()[0], 39.0);
}

TEST_F(InProcessWorldTest, ThePlantGoesOnUnderTheLastTorqueWhereAFrameIsLost) {
  configuration_.camera.drop_rate = 0.2;
  const TrialOutcome outcome = run();
  ASSERT_EQ(outcome.states.size(), 40u);  // a trial counts what is seen
  ASSERT_EQ(outcome.times.size(), 40u);
  ASSERT_EQ(outcome.torques.size(), 40u);
  EXPECT_EQ(outcome.times[0], 0.0);
  const auto plant = makePlant(configuration_.plant, configuration_.camera);
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

TEST_F(InProcessWorldTest, NoPairOfTheBagStraddlesALostFrame) {
  configuration_.camera.drop_rate = 0.2;
  const TrialOutcome outcome = run();
  std::vector<Eigen::Index> expected = {0};  // first frames of the pieces
  for (size_t t = 0; t + 1 < 40; ++t) {
    if (stepsAfter(outcome, t) > 1) expected.push_back(static_cast<Eigen::Index>(t) + 1);
  }
  ASSERT_GT(expected.size(), 3u);
  const BagContent content = bag();
  EXPECT_EQ(content.data.numFrames(), 40);
  std::vector<Eigen::Index> begins;
  for (const Piece& piece : content.data.pieces()) begins.push_back(piece.begin);
  EXPECT_EQ(begins, expected);
}

TEST_F(InProcessWorldTest, FramesAndGoalAreThoseOfTheCameraInThisRun) {
  configuration_.camera.noise_std = 0.05;
  configuration_.camera.brightness_drift = 0.2;
  configuration_.camera.clutter = 0.6;
  configuration_.camera.delay = 2;
  configuration_.camera.drop_rate = 0.2;
  const TrialOutcome outcome = run();
  const BagContent content = bag();
  const auto plant = makePlant(configuration_.plant, configuration_.camera);
  Camera camera(configuration_.camera);
  camera.begin(7, 2, false);
  EXPECT_EQ(content.data.goal(), camera.photographGoal(*plant));
  plant->setState(outcome.states[0]);
  for (Eigen::Index t = 0; t < 40; ++t) {
    auto photograph = camera.photograph(*plant);
    while (!photograph) {
      plant->step(outcome.torques[static_cast<size_t>(t) - 1]);
      photograph = camera.photograph(*plant);
    }
    ASSERT_EQ(content.data.image(t), *photograph) << t;
    plant->step(outcome.torques[static_cast<size_t>(t)]);
  }
}

}  // namespace
}  // namespace ddm
