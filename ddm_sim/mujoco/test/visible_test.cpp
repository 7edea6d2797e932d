// Tests the visibility of models: hidden groups, missing light, images that do not change.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_plant.h"
#include "model_folder.h"

namespace ddm {
namespace {

using testing::ModelFolder;
using testing::refusalOf;

/// MJCF of a rod that turns in front of a camera.
struct Rod {
  std::string geom = "group='0'";
  std::string second;  ///< another geom of the rod
  std::string light = "<light pos='0 -3 3'/>";
  std::string visual;
  std::string camera = "<camera pos='0 -4 0' xyaxes='1 0 0 0 0 1'/>";

  std::string text() const {
    return "<mujoco><visual>" + visual + "</visual><worldbody>" + light + camera +
           "<body><joint name='hinge' axis='0 1 0'/><geom type='capsule' fromto='0 0 0 0 0 1' "
           "size='0.1' "
           "mass='1' " +
           geom + "/>" + second +
           "</body></worldbody><actuator><motor joint='hinge' ctrllimited='true' "
           "ctrlrange='-1 1'/></actuator></mujoco>";
  }
};

MujocoOptions rodOptions() {
  MujocoOptions options;
  options.model = "rod";
  options.dt = 0.1;
  options.tolerance = 10.0;
  return options;
}

class VisibleTest : public ::testing::Test {
 protected:
  /// Grey values of an image of the upright rod.
  std::vector<std::uint8_t> image(const Rod& rod) const {
    const auto model = folder_.loadText(rod.text());
    requireVisible(model, rodOptions());
    const MujocoPlant plant(model, rodOptions());
    return plant.render(plant.state()).bytes;
  }

  ::testing::AssertionResult isRefused(const Rod& rod,
                                       const std::vector<std::string>& words) const {
    const auto model = folder_.loadText(rod.text());
    return testing::names(refusalOf([&] { requireVisible(model, rodOptions()); }), words);
  }

  ModelFolder folder_;
};

TEST_F(VisibleTest, DrawsGeomsOfAnyGroup) {
  const auto expected = image(Rod());
  for (const char* group : {"group='1'", "group='2'", "group='3'", "group='4'", "group='5'"}) {
    Rod rod;
    rod.geom = group;
    EXPECT_EQ(image(rod), expected) << group;
  }
}

TEST_F(VisibleTest, DrawsNoCollisionShapeWhereThereIsAVisualOne) {
  Rod rod;
  const auto expected = image(rod);
  rod.second = "<geom type='sphere' size='0.5' mass='0' group='3'/>";
  EXPECT_EQ(image(rod), expected);
}

TEST_F(VisibleTest, HasLightWhereTheFileHasNone) {
  Rod rod;
  rod.light = "";
  rod.visual = "<headlight active='0'/>";
  const auto bytes = image(rod);
  EXPECT_GT(*std::max_element(bytes.begin(), bytes.end()), 50);
  rod.visual = "<headlight ambient='0 0 0' diffuse='0 0 0' specular='0 0 0'/>";
  EXPECT_EQ(image(rod), bytes);
}

TEST_F(VisibleTest, RefusesAModelWhoseMotionIsNotSeenWithTheCause) {
  Rod away;
  away.camera = "<camera pos='0 -4 0' xyaxes='-1 0 0 0 0 1'/>";
  EXPECT_TRUE(isRefused(
      away, {"plant/camera", "model.xml", "equal in all poses", "camera is at (0, -4, 0)"}));
  Rod far;
  far.visual = "<map zfar='0.5'/>";
  EXPECT_TRUE(isRefused(far, {"plant/camera", "nothing farther than", "<statistic extent>"}));
  Rod transparent;
  transparent.geom = "rgba='1 1 1 0'";
  EXPECT_TRUE(isRefused(transparent, {"plant/camera", "transparent"}));
  Rod turning_about_itself;
  turning_about_itself.geom = "type='sphere' pos='0 0 0'";
  std::string text = turning_about_itself.text();
  text.replace(text.find("type='capsule' fromto='0 0 0 0 0 1' "), 36, "");
  const auto ball = folder_.loadText(text);
  EXPECT_TRUE(testing::names(refusalOf([&] { requireVisible(ball, rodOptions()); }),
                             {"plant/camera", "does not move"}));
}

TEST_F(VisibleTest, RefusesAUrdfWithoutShapes) {
  const std::string inertial =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
      "iyz='0'/></inertial>";
  const auto model =
      folder_.loadText("<robot name='bare'><link name='a'/><link name='b'>" + inertial +
                           "</link><joint name='hinge' type='continuous'><parent link='a'/><child "
                           "link='b'/></joint></robot>",
                       "bare.urdf");
  MujocoOptions options = rodOptions();
  options.motors = {"hinge"};
  options.max_torque = {1.0};
  options.look.position = {0.0, -4.0, 0.0};
  options.look.look_at = {0.0, 0.0, 0.0};
  EXPECT_TRUE(
      testing::names(refusalOf([&] { requireVisible(model, options); }),
                     {"plant/camera", "no link that a joint moves has a shape", "<visual>"}));
}

/// The list has each kind of actuator in MuJoCo, on the plant's own joint or on another one.
TEST(Motors, SwitchOffAllActuatorsOfTheFile) {
  const std::string actuators[] = {
      "<position joint='hinge' kp='50'/>",
      "<position joint='other' kp='50'/>",
      "<velocity joint='hinge' kv='5'/>",
      "<intvelocity joint='hinge' kp='5' actrange='-1 1'/>",
      "<damper joint='hinge' kv='5' ctrlrange='0 1'/>",
      "<cylinder joint='hinge' timeconst='1' area='1' bias='1 1 1'/>",
      "<general joint='hinge' biastype='affine' biasprm='3 -20 0'/>",
      "<general joint='hinge' dyntype='filter' dynprm='0.1' biastype='affine' biasprm='3 0 0'/>",
      "<muscle joint='hinge' lengthrange='-1 1'/>",
      "<muscle tendon='cord' lengthrange='0.1 2'/>",
      "<position tendon='cord' kp='50'/>",
      "<adhesion body='lower' ctrlrange='0 1' gain='1'/>",
      "<motor joint='hinge' ctrllimited='true' ctrlrange='0 1'/>"};
  const auto stateAfter = [](const std::string& actuator) {
    MujocoOptions options = rodOptions();
    options.motors = {"hinge"};
    options.max_torque = {1.0};
    options.goal = {0.0, 0.0};
    options.start = {0.5, -0.3};
    const auto plant = testing::plantOf(
        "<mujoco><worldbody><camera pos='0 -4 0' xyaxes='1 0 0 0 0 1'/><site name='fixed' pos='0 0 "
        "2'/>"
        "<body><joint name='hinge' axis='0 1 0' damping='0.1'/><geom type='capsule' fromto='0 0 0 "
        "0 0 1' "
        "size='0.1'/><body name='lower' pos='0 0 1'><joint name='other' axis='0 1 0' "
        "damping='0.1'/>"
        "<geom type='capsule' fromto='0 0 0 0 0 0.5' size='0.1' contype='0' conaffinity='0'/>"
        "<site name='moving' pos='0 0 0.5'/></body></body></worldbody><tendon><spatial name='cord'>"
        "<site site='fixed'/><site site='moving'/></spatial></tendon><actuator>" +
            actuator + "</actuator></mujoco>",
        options);
    for (int t = 0; t < 5; ++t) plant->step(Eigen::VectorXd::Constant(1, 0.7));
    return plant->state();
  };
  const Eigen::VectorXd alone = stateAfter("");
  for (const std::string& actuator : actuators) EXPECT_EQ(stateAfter(actuator), alone) << actuator;
}

}  // namespace
}  // namespace ddm
