// Tests plants with a model file: motion, motors, initial states and goals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_sim/plant.h"
#include "model_folder.h"

namespace ddm {
namespace {

using testing::arm;
using testing::armOptions;
using testing::armText;
using testing::armUrdf;
using testing::ModelFolder;
using testing::plantOf;
using testing::refusalOf;
using testing::urdfOptions;
using Names = std::vector<std::string>;

TEST(MujocoPlant, HasTheColumnsLimitsAndJointsOfItsFile) {
  const PlantInfo info = arm()->info();
  EXPECT_EQ(info.state_names,
            (Names{"shoulder_rad", "elbow_rad", "shoulder_rad_per_s", "elbow_rad_per_s"}));
  EXPECT_EQ(info.torque_names, (Names{"shoulder_nm", "elbow_nm"}));
  EXPECT_EQ(info.joints[1].name, "elbow");
  EXPECT_DOUBLE_EQ(info.max_torque[0], 1.0);  // gear times ctrlrange
  EXPECT_DOUBLE_EQ(info.max_torque[1], 0.4);
  EXPECT_EQ(info.error_unit, "deg");
  EXPECT_EQ(info.goal, Eigen::Vector4d(1.0, 0.5, 0.0, 0.0));
}

TEST(MujocoPlant, TurnsTheJointsOfAUrdfInTheOrderOfItsMotors) {
  const auto plain = plantOf(armUrdf(), urdfOptions(), "arm.urdf");
  EXPECT_EQ(plain->info().torque_names, (Names{"elbow_nm", "shoulder_nm"}));
  plain->step(Eigen::Vector2d(0.5, 0.0));
  EXPECT_GT(plain->state()[1], 0.0);  // the elbow is the second joint
}

TEST(MujocoPlant, TakesTheEffortOfAUrdfForTheLimitOfTheMotor) {
  MujocoOptions options = urdfOptions();
  options.motors = {"elbow"};
  options.max_torque.clear();
  EXPECT_EQ(plantOf(armUrdf(), options, "arm.urdf")->info().max_torque[0], 3.0);
}

TEST(MujocoPlant, EndsAnUnstableTrialAndIsAsGoodAsNewAfterwards) {
  // Ten physics steps with this damping multiply a rate beyond all bounds.
  const std::string text = R"(<mujoco><option timestep="0.1" integrator="RK4" gravity="0 0 0"/>
    <worldbody><camera pos="0 0 1"/><body><joint name="hinge" damping="1000"/><geom size="0.1" mass="0.01"/></body></worldbody>
    <actuator><motor joint="hinge" ctrllimited="true" ctrlrange="-1 1"/></actuator></mujoco>)";
  MujocoOptions options;
  options.model = "stiff";
  options.dt = 1.0;
  options.tolerance = 1.0;
  const ModelFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto plant = std::make_unique<MujocoPlant>(folder.loadText(text), options);
  const Eigen::Vector2d start(0.5, 3.0);
  plant->setState(start);
  EXPECT_TRUE(testing::throwsNaming<std::range_error>(
      [&] { plant->step(Eigen::VectorXd::Zero(1)); }, {"unstable", "timestep"}));
  EXPECT_EQ(plant->state(), start);
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
  std::filesystem::current_path(before);
  plant->setState(Eigen::Vector2d(0.25, 0.0));
  plant->step(Eigen::VectorXd::Zero(1));
  EXPECT_EQ(plant->state(), Eigen::Vector2d(0.25, 0.0));
}

TEST(MujocoPlant, DrawsStartsFromNormalAndUniformParts) {
  MujocoOptions options = armOptions();
  options.start = {0.5, -0.25};
  options.start_std = {0.0, 0.0, 0.0, 0.1};
  options.start_uniform = {kPi, 0.1};
  const auto plant = arm(options);
  EXPECT_EQ(plant->info().start, Eigen::Vector4d(0.5, -0.25, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(plant->info().start_std[0], kPi / std::sqrt(3.0));
  std::mt19937_64 engine(1);
  double widest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::VectorXd start = plant->drawStart(engine);
    ASSERT_LE(std::abs(start[0] - 0.5), kPi);
    ASSERT_LE(std::abs(start[1] + 0.25), 0.1);
    ASSERT_EQ(start[2], 0.0);
    widest = std::max(widest, std::abs(start[0] - 0.5));
  }
  EXPECT_GT(widest, 0.98 * kPi);
}

TEST(MujocoPlant, ReachesATargetExactlyOrRefusesIt) {
  MujocoOptions options = armOptions();
  options.goal_site = "tip";
  options.goal_distance = {0.15, 0.25};
  options.visible_sites = {"tip"};
  const auto plant = arm(options);
  for (const Eigen::Vector2d& target :
       {Eigen::Vector2d(0.2, 0.1), Eigen::Vector2d(-0.15, 0.0), Eigen::Vector2d(0.0, -0.29)}) {
    const Eigen::VectorXd goal = plant->goalAt(target);
    EXPECT_LE((plant->visiblePosition(goal).head(2) - target).norm(), 1e-13);
    EXPECT_EQ(plant->goalAt(target), goal);
  }
  EXPECT_NE(refusalOf([&] { plant->goalAt(Eigen::Vector2d(0.25, 0.25)); }).find("reach"),
            std::string::npos);
  EXPECT_THROW(plant->goalAt(Eigen::Vector3d(0.1, 0.1, 0.1)), std::invalid_argument);
  EXPECT_THROW(arm()->goalAt(Eigen::Vector2d(0.1, 0.1)), std::invalid_argument);
}

TEST(MujocoPlant, ShowsTheTargetToPeopleAlone) {
  MujocoOptions options = armOptions();
  options.goal_site = "tip";
  options.goal_distance = {0.15, 0.25};
  // The learner's images show group 0, with the target where the file has it.
  for (const char* group : {"4", "0"}) {
    const auto plant = plantOf(armText(R"(<worldbody><body name="target" mocap="true"
        pos="-0.1 -0.1 0"><geom size="0.03" contype="0" conaffinity="0" group=")" +
                                       std::string(group) + "\"/></body></worldbody>"),
                               options);
    const Eigen::VectorXd state = plant->state();
    const RenderedImage view = plant->view(state), image = plant->render(state);
    EXPECT_EQ(view.width, 640);
    EXPECT_EQ(plant->viewModel()->height, 480);
    EXPECT_EQ(plant->cameraModel()->width, 51);
    plant->setGoal(plant->goalAt(Eigen::Vector2d(-0.2, 0.1)));
    EXPECT_NE(plant->view(state).bytes, view.bytes);
    EXPECT_EQ(plant->render(state).bytes, image.bytes);
  }
}

TEST(MujocoPlant, HasTheTimestepOfItsOptions) {
  MujocoOptions options = armOptions();
  options.timestep = 0.0125;
  options.dt = 0.025;  // not a multiple of the file's 0.01 s
  const auto coarse = arm(options);
  options.timestep = 0.00125;
  const auto fine = arm(options);
  for (const auto& plant : {coarse.get(), fine.get()}) plant->step(Eigen::Vector2d(0.5, 0.0));
  EXPECT_NE(coarse->state()[0], fine->state()[0]);
  EXPECT_NEAR(coarse->state()[0], fine->state()[0], 0.5 * std::abs(fine->state()[0]));
  options.timestep = 0.01;
  EXPECT_TRUE(
      testing::names(refusalOf([&] { arm(options); }), {"plant/dt", "plant/timestep", "0.01"}));
}

TEST(MujocoPlant, RefusesNamesOfJointsThatHeadNoColumn) {
  for (const char* name : {"shoul der", "shoul,der"}) {
    std::string text = armText();
    for (const char* attribute : {" name=", " joint="}) {
      const std::string old = attribute + std::string("\"shoulder\"");
      text.replace(text.find(old), old.size(), attribute + ("\"" + std::string(name) + "\""));
    }
    MujocoOptions options = armOptions();
    options.state_names = {"a", "b", "c", "d"};  // do not name the joint
    options.torque_names = {"e", "f"};
    EXPECT_TRUE(testing::names(refusalOf([&] { plantOf(text, options); }),
                               {"the joint \"" + std::string(name), "model.xml", "rename it"}));
  }
}

TEST(MujocoPlant, TakesTheLimitsOfActuatorsThatNamedMotorsReplace) {
  const auto limit = [](const std::string& actuators) {
    std::string text = armText();
    const std::size_t begin = text.find("<motor"), end = text.find("</actuator>");
    text.replace(begin, end - begin, actuators);
    MujocoOptions options = armOptions();
    options.motors = {"elbow"};
    return plantOf(text, options)->info().max_torque[0];
  };
  const std::string motor = "<motor joint='elbow' gear='2' ctrlrange='-1 1'/>";
  EXPECT_EQ(limit(motor), 2.0);
  EXPECT_EQ(limit("<motor joint='elbow' gear='-2' ctrlrange='-1 3'/>"), 2.0);
  EXPECT_EQ(limit("<position joint='elbow' gear='2' kp='9' ctrlrange='-1 1' forcerange='-3 3'/>"),
            6.0);
  for (const char* none : {"<motor joint='shoulder' ctrlrange='-1 1'/>", "<motor joint='elbow'/>",
                           "<position joint='elbow' kp='9' ctrlrange='-1 1'/>"}) {
    EXPECT_TRUE(testing::names(refusalOf([&] { limit(none); }), {"has no limit", "elbow"})) << none;
  }
}

TEST(MujocoPlant, MeasuresTheErrorOfTheJointsOrSitesThatCount) {
  const Eigen::Vector4d state(1.0 + 2.0 * kPi, 0.5 + 0.2, 9.0, 9.0);
  EXPECT_NEAR(arm()->goalError(state), 0.2 * 180.0 / kPi, 1e-9);
  MujocoOptions options = armOptions();
  options.error_sites = {"tip"};
  EXPECT_NEAR(arm(options)->goalError(state), 2.0 * 0.1 * std::sin(0.1), 1e-12);
  // Hinges count before slides.
  const std::string text = testing::replaced(armText(), "name=\"elbow\" axis=\"0 0 1\"",
                                             "name=\"elbow\" type=\"slide\"");
  EXPECT_NEAR(plantOf(text, armOptions())->goalError(state), 0.0, 1e-9);
}

}  // namespace
}  // namespace ddm
