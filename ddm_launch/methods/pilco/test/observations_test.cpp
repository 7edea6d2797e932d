// Tests of the observations of the baselines, and of the task in their coordinates.
// SPDX-License-Identifier: BSD-3-Clause

#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <ddm_sim/plant.h>
#include <gtest/gtest.h>

#include <boost/filesystem.hpp>
#include <cmath>

#include "pilco/pilco_method.h"
#include "tables.h"
#include "toy_run.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::throwsNaming;
using testing::writeText;

Eigen::VectorXd pair(double first, double second) {
  Eigen::VectorXd out(2);
  out << first, second;
  return out;
}

std::unique_ptr<Plant> pendulum() { return makePlant(*testing::plantOf("{type: pendulum}")); }

/// An arm as another package could define it: one joint with angle and rate.
testing::ToyPlant::Traits armTo(double angle) {
  testing::ToyPlant::Traits traits;
  traits.info.joints = {{"arm", JointKind::kAngle}};
  traits.info.state_names = {"angle_rad", "rate_rad_per_s"};
  traits.info.goal = pair(angle, 0.0);
  return traits;
}

class TrueStateTest : public ::testing::Test {
 protected:
  std::unique_ptr<Plant> plant_ = pendulum();
  testing::TempFolder scratch_;
};

TEST_F(TrueStateTest, LearningMeetsTheMeasurementsThatThePolicyActedOn) {
  const auto acting = observeTrueState({}, *plant_);
  const TrialId id{5, 0, false};
  std::vector<Eigen::VectorXd> states, measured;
  std::vector<double> times;
  DataSet data(2, 1);
  acting->startTrial(id);
  for (int t = 0; t < 20; ++t) {
    states.push_back(plant_->state());
    times.push_back(0.2 * t);
    measured.push_back(acting->observe({}));
    data.append(Image(4, 0), Eigen::VectorXd::Zero(1), t == 0);
    plant_->step(Eigen::VectorXd::Constant(1, 0.3 * t));
  }
  writeText(scratch_.file("trajectory.csv"),
            formatTrajectoryCsv(times, states, plant_->info().state_names));
  const Eigen::MatrixXd X =
      observeTrueState({}, *plant_)->learn({scratch_.file("trial.bag")}, data, id).X;
  ASSERT_EQ(X.cols(), 20);
  for (int t = 0; t < 20; ++t) EXPECT_EQ(X.col(t), measured[static_cast<size_t>(t)]) << t;
  EXPECT_NE(X(0, 19), states[19][1]);
  EXPECT_NEAR(X(1, 19), states[19][0], 0.05);  // five standard deviations of the angle's noise
}

TEST_F(TrueStateTest, FramesThatDoNotFitTheBagBesideThemAreRefusedWithTheFile) {
  DataSet data(2, 1);  // two trials of 3 samples
  for (int t = 0; t < 6; ++t) data.append(Image(4, 0), Eigen::VectorXd::Zero(1), t % 3 == 0);
  const auto observation = observeTrueState({}, *plant_);
  std::vector<std::string> bags;
  const auto write = [&](const std::string& trial, size_t frames) {
    fs::create_directories(scratch_.file(trial));
    const std::vector<Eigen::VectorXd> states(frames, plant_->state());
    writeText(
        scratch_.file(trial + "/trajectory.csv"),
        formatTrajectoryCsv(std::vector<double>(frames, 0.0), states, plant_->info().state_names));
    bags.push_back(scratch_.file(trial + "/trial.bag"));
  };
  const auto learn = [&] { observation->learn(bags, data, TrialId()); };
  write("a", 2);
  write("b", 4);  // the total number of samples is correct
  EXPECT_TRUE(throwsNaming<std::runtime_error>(
      learn, {"a/trajectory.csv", "the 3 frames", "got 2", "use another"}));
  bags.clear();
  write("a", 3);
  write("b", 3);
  EXPECT_NO_THROW(learn());
}

PilcoTask trueStateTask(const Plant& plant) {
  return observeTrueState({}, plant)->learn({}, DataSet(2, 1), TrialId()).task;
}

TEST_F(TrueStateTest, TheTaskIsUprightWithinTheLengthOfTheRodAlsoForAPlugin) {
  plant_ = makePlant(*testing::plantOf("{type: pendulum, length: 2.0, start_std: [0.3, 0.5]}"));
  const PilcoTask task = trueStateTask(*plant_);
  EXPECT_EQ(task.angles, std::vector<int>{1});
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2, 2);
  covariance.diagonal() << 0.5 * 0.5, 0.3 * 0.3;  // the rate is first
  EXPECT_EQ(task.start.covariance, covariance);
  EXPECT_EQ(task.start.mean, Eigen::VectorXd::Zero(2));
  const std::unique_ptr<Plant> plugin = makePlant(testing::ToyPlugin(armTo(-M_PI)));
  for (const PilcoTask& each : {task, trueStateTask(*plugin)}) {
    for (const double angle : {0.0, 1.0, 3.0, M_PI}) {
      const double lengths = 2.0 * std::cos(angle / 2.0);  // distance of the tip from its goal
      EXPECT_NEAR(each.cost.expected(pilco::known(pair(0.0, angle))),
                  1.0 - std::exp(-2.0 * lengths * lengths), 1e-12);
    }
  }
}

TEST_F(TrueStateTest, APlantThatIsNoPendulumIsRefused) {
  testing::ToyPlant::Traits length = armTo(M_PI), two_joints = armTo(M_PI);
  length.info.joints[0].kind = JointKind::kLength;
  two_joints.info.joints = {{"shoulder", JointKind::kAngle}, {"elbow", JointKind::kAngle}};
  two_joints.info.state_names = {"shoulder_rad", "elbow_rad"};
  for (const testing::ToyPlant::Traits& traits : {length, two_joints, armTo(0.0)}) {
    const std::unique_ptr<Plant> plant = makePlant(testing::ToyPlugin(traits));
    EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { observeTrueState({}, *plant); },
                                                    {"joint(s)", "pilco_features"}));
  }
}

/// Images of a rod that rotates, and the goal image.
DataSet imagesOf(const Plant& plant) {
  DataSet data(plant.render(plant.state()).width, 1);
  for (int t = 0; t < 40; ++t) {
    data.append(plant.render(pair(0.15 * t, 0.0)).bytes, Eigen::VectorXd::Zero(1), t == 0);
  }
  data.setGoal(plant.render(plant.goal()).bytes);
  return data;
}

/// Checks that observe() gives the same x as learn(), and that the goal image has zero cost.
void expectConsistent(Observation* observation, const DataSet& data) {
  const auto [X, task] = observation->learn({}, data, TrialId());
  ASSERT_EQ(X.rows(), static_cast<Eigen::Index>(observation->names().size()));
  ASSERT_EQ(X.cols(), data.numFrames());
  const Eigen::VectorXd x = observation->observe(data.image(7));
  EXPECT_LT((x - X.col(7)).norm(), 1e-5 * X.norm());
  EXPECT_NEAR(task.cost.expected(pilco::known(observation->observe(data.goal()))), 0.0, 1e-9);
  EXPECT_GT(task.cost.expected(pilco::known(X.col(0))), 0.5);
}

TEST(ImageObservations, LearnFromWhatTheyObserveAndTakeTheGoalFromItsImage) {
  const std::unique_ptr<Plant> plant = pendulum();
  const DataSet data = imagesOf(*plant);
  Configuration all;
  all.model.model.pca_dim = 5;
  all.model.training.max_iterations = 30;
  all.model.training.schedule = "v_r_only";
  expectConsistent(observeFeatures(all, *plant).get(), data);
  expectConsistent(observePrincipalComponents(all, *plant).get(), data);
}

TEST(ImageTask, TakesGoalStartAndScaleFromTheData) {
  Eigen::MatrixXd X(2, 4);
  X << 1, 0, 3, 0,  //
      0, 1, 2, -1;
  const std::vector<Segment> segments = {{0, 2}, {2, 2}};
  const Eigen::VectorXd goal = pair(-1.0, 0.0);
  const PilcoTask task = imageTask(X, segments, goal);
  const double spread = std::sqrt(2.0 + 5.0 / 3.0);  // sample variances of the two rows
  EXPECT_TRUE(task.angles.empty());
  EXPECT_NEAR(task.cost.expected(pilco::known(goal)), 0.0, 1e-15);
  EXPECT_NEAR(task.cost.expected(pilco::known(goal + pair(0.5 * spread, 0.0))),
              1.0 - std::exp(-0.5), 1e-12);
  EXPECT_EQ(task.start.mean, pair(2.0, 1.0));
  // The scatter of (1, 0) and (3, 2) is 2 in all entries; the prior is (0.1 spread)^2 / 2.
  const double prior = 0.01 * spread * spread / 2.0;
  EXPECT_NEAR(task.start.covariance(0, 0), (2.0 + prior) / 2.0, 1e-12);
  EXPECT_NEAR(task.start.covariance(0, 1), 1.0, 1e-12);
}

}  // namespace
}  // namespace ddm
