// Tests URDF files: messages for invalid files, and the models of valid ones.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <boost/algorithm/string/case_conv.hpp>
#include <clocale>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "model_files.h"
#include "model_folder.h"

namespace ddm {
namespace {

using testing::ModelFolder;
using testing::refusalOf;
using testing::urdfOptions;

/// Text of a URDF: a base, a thigh on the joint `hip`, and the elements in `more`.
struct Leg {
  std::string type = "continuous";
  std::string mass = "<mass value='1'/>";
  std::string inertia = "<inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/>";
  std::string shape = "<box size='0.2 0.1 0.6'/>";
  std::string in_joint;
  std::string more;

  std::string text() const {
    return "<robot name='leg'>\n<link name='base'/>\n<link name='thigh'><inertial>" + mass +
           inertia + "</inertial><visual><geometry>" + shape +
           "</geometry></visual></link>\n<joint name='hip'" +
           (type.empty() ? "" : " type='" + type + "'") +
           "><parent link='base'/><child link='thigh'/><axis xyz='0 1 0'/>" + in_joint +
           "</joint>\n" + more + "</robot>";
  }
};

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/><axis xyz='0 1 0'/>" + more + "</joint>";
}

std::string link(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><mass value='0.1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' "
         "iyz='0'/></inertial></link>";
}

class UrdfTest : public ::testing::Test {
 protected:
  ::testing::AssertionResult isRefused(const Leg& leg,
                                       const std::vector<std::string>& words) const {
    return testing::names(refusalOf([&] { folder_.loadText(leg.text(), "leg.urdf"); }), words);
  }

  ::testing::AssertionResult isRefusedWith(const std::string& more,
                                           const std::vector<std::string>& words) const {
    Leg leg;
    leg.more = more;
    return isRefused(leg, words);
  }

  std::shared_ptr<const MujocoModel> load(const Leg& leg) const {
    return folder_.loadText(leg.text(), "urdf/leg.urdf");
  }

  std::shared_ptr<const MujocoModel> loadWith(const std::string& more) const {
    Leg leg;
    leg.more = more;
    return load(leg);
  }

  /// Writes a tetrahedron in STL format.
  void writeStl(const std::string& name, float size, bool ascii) const {
    const float corners[4][3] = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
    const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    std::ostringstream text;
    text << "solid\n";
    std::string binary = "solid" + std::string(75, ' ') + std::string("\x04\0\0\0", 4);
    for (const auto& face : faces) {
      text << "facet normal 0 0 0\nouter loop\n";
      char raw[50] = {};
      for (int k = 0; k < 3; ++k) {
        const float* const corner = corners[face[k]];
        text << "vertex " << corner[0] << ' ' << corner[1] << ' ' << corner[2] << '\n';
        std::memcpy(raw + 12 * (k + 1), corner, 12);
      }
      text << "endloop\nendfacet\n";
      binary.append(raw, sizeof(raw));
    }
    folder_.write(name, ascii ? text.str() + "endsolid\n" : binary);
  }

  ModelFolder folder_;
};

TEST_F(UrdfTest, NamesAJointOfAnUnknownTypeAndThoseThatThereAre) {
  Leg leg;
  leg.type = "Revolute";
  EXPECT_TRUE(isRefused(leg, {"hip", "Revolute", "line 4", "revolute", "continuous", "prismatic"}));
  leg.type = "";
  EXPECT_TRUE(isRefused(leg, {"hip", "none", "revolute"}));
  for (const char* type : {"floating", "planar"}) {
    leg.type = type;
    EXPECT_TRUE(isRefused(leg, {"hip", type, "hinges and slides"}));
  }
}

TEST_F(UrdfTest, NamesWhatIsWrongWithTheTree) {
  EXPECT_TRUE(isRefusedWith(joint("weld", "fixed", "world", "base"),
                            {"weld", "world", "not declared", "<link name=\"world\"/>"}));
  EXPECT_TRUE(
      isRefusedWith(joint("knee", "continuous", "thigh", "shank"), {"knee", "child", "shank"}));
  EXPECT_TRUE(isRefusedWith(link("stray"), {"root", "base", "stray", "fixed joints"}));
  EXPECT_TRUE(isRefusedWith(link("other") + joint("second", "fixed", "other", "thigh"),
                            {"second", "thigh", "hip", "one parent"}));
  EXPECT_TRUE(isRefusedWith(joint("back", "fixed", "thigh", "base"), {"back", "base", "cycle"}));
  EXPECT_TRUE(isRefusedWith(link("world") + joint("knee", "continuous", "thigh", "world"),
                            {"knee", "child link world", "rename"}));
  EXPECT_TRUE(isRefusedWith("<joint name='knee' type='fixed'><parent link='base'/></joint>",
                            {"knee", "child"}));
}

TEST_F(UrdfTest, KeepsALinkThatIsCalledWorld) {
  const auto model = loadWith("<link name='world'/>" + joint("weld", "fixed", "world", "base"));
  EXPECT_EQ(model->get().njnt, 1);
}

TEST_F(UrdfTest, NamesALinkWithoutMassOrInertia) {
  Leg leg;
  leg.inertia = "<inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/>";
  EXPECT_TRUE(isRefused(leg, {"inertia", "thigh", "point mass"}));
  leg.mass = "<mass value='0'/>";
  EXPECT_TRUE(isRefused(leg, {"mass", "thigh", "> 0"}));
  EXPECT_TRUE(isRefusedWith(
      "<link name='frame'/><link name='weight'><inertial><mass value='1'/></inertial></link>" +
          joint("knee", "continuous", "thigh", "frame") + joint("weld", "fixed", "frame", "weight"),
      {"frame", "no <inertial>", "weight", "point mass"}));
}

TEST_F(UrdfTest, NamesALinkWithAnInertiaThatNoBodyHasButTakesRounding) {
  const auto with = [](const std::string& numbers) {
    Leg leg;
    leg.inertia = "<inertia " + numbers + " ixz='0' iyz='0'/>";
    return leg;
  };
  for (const char* numbers :
       {"ixx='0.02' iyy='0.02' izz='0.5' ixy='0'", "ixx='0.02' iyy='0.02' izz='0.01' ixy='0.5'"}) {
    EXPECT_TRUE(isRefused(with(numbers), {"thigh", "line 3", "principal inertias"})) << numbers;
  }
  const auto nearly = load(with("ixx='0.001' iyy='0.01' izz='0.015' ixy='0'"));
  // MuJoCo sorts principal inertias, largest first.
  const mjtNum* const kept = nearly->get().body_inertia + 3;
  EXPECT_NEAR(kept[0], 0.015, 1e-12);
  EXPECT_NEAR(kept[1], 0.01, 1e-12);
  EXPECT_NEAR(kept[2], 0.005, 1e-7);
  EXPECT_EQ(load(with("ixx='0.01' iyy='0.01' izz='0.01' ixy='0.01'"))->get().njnt, 1);
  Leg balanced = with("ixx='0.02' iyy='0.02' izz='0.5' ixy='0'");
  balanced.more = "<mujoco><compiler balanceinertia='true'/></mujoco>";
  EXPECT_EQ(load(balanced)->get().njnt, 1);
}

TEST_F(UrdfTest, CorrectsInertiasInALocaleWithADecimalComma) {
  if (std::setlocale(LC_NUMERIC, "de_DE.UTF-8") == nullptr) GTEST_SKIP() << "no locale de_DE.UTF-8";
  Leg leg;
  leg.inertia = "<inertia ixx='0.001' iyy='0.01' izz='0.015' ixy='0' ixz='0' iyz='0'/>";
  EXPECT_EQ(refusalOf([&] { load(leg); }), "");
  std::setlocale(LC_NUMERIC, "C");
}

TEST_F(UrdfTest, TakesAnyInertiaOfTheRootLinkWhichNeverMoves) {
  const std::string text = testing::replaced(
      Leg().text(), "<link name='base'/>",
      "<link name='base'><inertial><mass value='1'/><inertia ixx='0.02' iyy='0.02' "
      "izz='0.5' ixy='0.3' ixz='0' iyz='0'/></inertial></link>");
  EXPECT_EQ(refusalOf([&] { folder_.loadText(text, "leg.urdf"); }), "");
}

TEST_F(UrdfTest, NamesAShapeThatUrdfDoesNotHave) {
  Leg leg;
  leg.shape = "<capsule radius='0.05' length='1'/>";
  EXPECT_TRUE(isRefused(leg, {"thigh", "capsule", "cylinder"}));
  leg.shape = "";
  EXPECT_TRUE(isRefused(leg, {"thigh", "geometry", "nothing"}));
  for (const char* size : {"<box size='0.1 0 0.1'/>", "<sphere radius='0'/>",
                           "<cylinder radius='0.1' length='-1'/>"}) {
    leg.shape = size;
    EXPECT_TRUE(isRefused(leg, {"thigh", "line 3", "> 0", "leave the shape out"})) << size;
  }
  leg.shape = "<mesh filename='a.stl' scale='1 1 0'/>";
  EXPECT_TRUE(isRefused(leg, {"thigh", "scale without 0", "\"1 1 0\""}));
}

TEST_F(UrdfTest, LetsContinuousJointsTurnWithoutEnd) {
  Leg leg;
  leg.in_joint = "<limit lower='-1' upper='1' effort='5' velocity='1'/>";
  EXPECT_EQ(load(leg)->get().jnt_limited[0], 0);
  EXPECT_EQ(load(leg)->effortLimit("hip"), 5.0);
  leg.type = "revolute";
  EXPECT_EQ(load(leg)->get().jnt_limited[0], 1);
}

TEST_F(UrdfTest, NamesLimitsThatCannotBe) {
  Leg leg;
  leg.type = "revolute";
  leg.in_joint = "<limit lower='1' upper='-1' effort='5' velocity='1'/>";
  EXPECT_TRUE(isRefused(leg, {"hip", "lower", "\"1\"", "\"-1\""}));
  for (const char* type : {"revolute", "prismatic"}) {
    leg.type = type;
    for (const char* limit :
         {"", "<limit effort='5' velocity='1'/>", "<limit lower='0' upper='0' effort='5'/>"}) {
      leg.in_joint = limit;
      EXPECT_TRUE(isRefused(leg, {"hip", "lower < upper", type, "fixed"})) << limit;
    }
  }
  leg.in_joint = "<limit lower='-90' upper='90' effort='5' velocity='1'/>";
  EXPECT_EQ(load(leg)->get().jnt_range[1], 90.0);  // in metres: the joint is prismatic
  leg.type = "revolute";
  EXPECT_TRUE(isRefused(leg, {"hip", "\"90\"", "URDF has radians"}));
  leg.in_joint = "<limit lower='-1' upper='1' effort='much' velocity='1'/>";
  EXPECT_TRUE(isRefused(leg, {"hip", "effort", "\"much\""}));
}

TEST_F(UrdfTest, TakesAnEffortOfZeroForUnknown) {
  Leg leg;
  leg.in_joint = "<limit effort='0' velocity='1'/>";
  MujocoOptions options = urdfOptions();
  options.motors = {"hip"};
  options.goal = {1.0};
  options.max_torque.clear();
  EXPECT_TRUE(testing::names(refusalOf([&] { MujocoPlant(load(leg), options); }),
                             {"plant/max_torque", "limit of 0", "hip"}));
  options.max_torque = {2.0};
  EXPECT_EQ(MujocoPlant(load(leg), options).info().max_torque[0], 2.0);
}

TEST_F(UrdfTest, LetsAJointFollowTheOneThatItMimics) {
  const auto follower = [](const std::string& mimic) {
    return link("finger") + joint("curl", "continuous", "thigh", "finger", mimic);
  };
  const auto model = loadWith(follower("<mimic joint='hip' multiplier='-0.5' offset='0.2'/>"));
  MujocoOptions options = urdfOptions();
  options.motors = {"hip"};
  options.max_torque = {1.0};
  options.start = {0.0, 0.2};
  MujocoPlant plant(model, options);
  for (int t = 0; t < 30; ++t) plant.step(Eigen::VectorXd::Constant(1, 0.1));
  EXPECT_GT(std::abs(plant.state()[0]), 0.2);
  EXPECT_NEAR(plant.state()[1], -0.5 * plant.state()[0] + 0.2, 0.01);
  EXPECT_TRUE(isRefusedWith(follower("<mimic joint='hop'/>"), {"curl", "hop", "hip"}));
  options.motors = {"hip", "curl"};
  EXPECT_TRUE(testing::names(refusalOf([&] { MujocoPlant(model, options); }),
                             {"plant/motors", "curl", "mimics the joint hip"}));
  Leg cycle;
  cycle.in_joint = "<mimic joint='curl'/>";
  cycle.more = follower("<mimic joint='hip'/>");
  EXPECT_TRUE(isRefused(cycle, {"curl -> hip -> curl", "remove one <mimic>"}));
}

TEST_F(UrdfTest, NamesWhatMujocoIgnoresInItsBlock) {
  EXPECT_TRUE(isRefusedWith("<mujoco><actuator><motor joint='hip'/></actuator></mujoco>",
                            {"<actuator>", "compiler, option, size", "MJCF"}));
  EXPECT_TRUE(
      isRefusedWith("<mujoco><compiler angle='degree'/></mujoco>", {"degree", "URDF has radians"}));
}

TEST_F(UrdfTest, TakesAMujocoBlockForWhatItNamesAndIgnoresOneInAComment) {
  const auto with_block = loadWith("<mujoco><option timestep='0.001'/></mujoco>");
  EXPECT_EQ(with_block->get().opt.timestep, 0.001);
  EXPECT_EQ(with_block->get().ngeom, 1);
  EXPECT_NE(with_block->get().opt.disableflags & mjDSBL_CONTACT, 0);
  EXPECT_EQ(loadWith("<!-- <mujoco><compiler/></mujoco> -->")->get().ngeom, 1);
  const auto touching = loadWith("<mujoco><option><flag contact='enable'/></option></mujoco>");
  EXPECT_EQ(touching->get().opt.disableflags & mjDSBL_CONTACT, 0);
}

TEST_F(UrdfTest, LooksForPackagesInMeshesAlone) {
  EXPECT_EQ(loadWith("<!-- <mesh filename='package://gone/x.dae'/> -->")->get().ngeom, 1);
  EXPECT_EQ(loadWith("<gazebo><plugin path='package://gone/x.so'/></gazebo>")->get().ngeom, 1);
  Leg leg;
  leg.shape = "<mesh filename='package://gone/meshes/x.stl'/>";
  EXPECT_TRUE(
      isRefused(leg, {"\"package://gone/meshes/x.stl\"", "ROS_PACKAGE_PATH", "relative path"}));
  leg.shape = "<mesh filename='http://gone/x.stl'/>";
  EXPECT_TRUE(isRefused(leg, {"\"http://gone/x.stl\"", "package://"}));
}

TEST_F(UrdfTest, DrawsTheVisualMeshOfTwoThatHaveOneName) {
  writeStl("visual/part.stl", 0.1F, false);
  writeStl("collision/part.stl", 0.4F, false);
  Leg leg;
  leg.shape =
      "<mesh filename='../visual/part.stl'/></geometry></visual><collision><geometry>"
      "<mesh filename='../collision/part.stl'/></geometry></collision>"
      "<visual><geometry><mesh filename='../visual/part.stl' scale='2 2 2'/>";
  const auto model = load(leg);
  EXPECT_EQ(model->get().nmesh, 3);
  std::vector<double> drawn;
  for (int i = 0; i < model->get().ngeom; ++i) {
    if (model->get().geom_group[i] < 3) drawn.push_back(model->get().geom_rbound[i]);
  }
  ASSERT_EQ(drawn.size(), 2U);
  EXPECT_LT(drawn[0], 0.2);
  EXPECT_NEAR(drawn[1], 2.0 * drawn[0], 1e-6);
}

TEST_F(UrdfTest, ReadsMeshesByAnyNameAndInText) {
  writeStl("meshes/UPPER.STL", 0.1F, false);
  writeStl("meshes/text.stl", 0.1F, true);
  const std::string whole = "file://" + folder_.path() + "/meshes/UPPER.STL";
  for (const std::string& name :
       {std::string("../meshes/UPPER.STL"), std::string("../meshes/text.stl"),
        std::string("package://robots/meshes/UPPER.STL"), whole}) {
    Leg leg;
    leg.shape = "<mesh filename='" + name + "'/>";
    const auto model = load(leg);
    EXPECT_EQ(model->get().nmesh, 1) << name;
    EXPECT_EQ(model->get().nmeshvert, 4) << name;
  }
  Leg leg;
  leg.shape = "<mesh filename='meshes/capitals.stl'/>";
  folder_.write("urdf/meshes/capitals.stl",
                " \n" + boost::to_upper_copy(readModelFile(folder_.path() + "/meshes/text.stl")));
  EXPECT_EQ(load(leg)->get().nmeshvert, 4);
  leg.shape = "<mesh filename='package://elsewhere/UPPER.STL'/>";
  leg.more = "<mujoco><compiler meshdir='../meshes'/></mujoco>";
  EXPECT_EQ(load(leg)->get().nmesh, 1);
}

TEST_F(UrdfTest, TakesAFlatMeshUnlessContactsNeedItsHull) {
  folder_.write("urdf/sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  Leg leg;
  leg.shape +=
      "</geometry></visual><collision><geometry><mesh filename='sheet.obj'/></geometry>"
      "</collision><visual><geometry><sphere radius='0.1'/>";
  EXPECT_EQ(refusalOf([&] { load(leg); }), "");
  leg.more = "<mujoco><option><flag contact='enable'/></option></mujoco>";
  const std::string text = refusalOf([&] { load(leg); });
  EXPECT_TRUE(testing::names(text, {"/urdf/sheet.obj", "no hull"}));
  EXPECT_EQ(text.find("1_sheet"), std::string::npos) << text;
}

TEST_F(UrdfTest, NamesAMeshThatMujocoCannotRead) {
  folder_.write("arm.DAE", "<COLLADA/>");
  Leg leg;
  leg.shape = "<mesh filename='arm.DAE'/>";
  leg.more =
      "<link name='hand'><visual><geometry><mesh filename='b.dae'/></geometry></visual></link>" +
      joint("grip", "fixed", "thigh", "hand");
  EXPECT_TRUE(isRefused(leg, {"arm.DAE, b.dae", "STL", "assimp export arm.DAE"}));
  folder_.write("page.stl", "<!DOCTYPE html>");
  leg.shape = "<mesh filename='page.stl'/>";
  EXPECT_TRUE(isRefused(leg, {"\"page.stl\"", "web page"}));
  folder_.write("short.stl", std::string(80, '\0') + "\x0c" + std::string(103, '\0'));
  leg.shape = "<mesh filename='.'/>";
  EXPECT_TRUE(isRefused(leg, {"names a folder"}));
  leg.shape = "<mesh filename='gone.stl'/>";
  EXPECT_TRUE(isRefused(leg, {"\"gone.stl\"", "not there"}));
  leg.more.clear();
  leg.shape = "<mesh filename='short.stl'/>";
  EXPECT_TRUE(isRefused(leg, {"short.stl has 184 bytes", "684", "export it again"}));
}

TEST_F(UrdfTest, NamesTheParentOfALinkBehindAFixedJoint) {
  const std::string tip = link("tip") + joint("weld", "fixed", "thigh", "tip");
  const auto model = loadWith(tip);
  EXPECT_TRUE(testing::names(refusalOf([&] { model->place("tip", "plant/error_sites"); }),
                             {"plant/error_sites", "tip", "fixed joint", "thigh", "fusestatic"}));
  const auto apart = loadWith(tip + "<mujoco><compiler fusestatic='false'/></mujoco>");
  EXPECT_GT(apart->place("tip", "plant/error_sites").id, 0);
}

TEST_F(UrdfTest, AsksForXacroToBeRun) {
  EXPECT_TRUE(isRefusedWith("<xacro:include filename='x'/>", {"line 5", "xacro", "run xacro"}));
  EXPECT_TRUE(isRefusedWith(joint("knee", "${kind}", "thigh", "shank"), {"${kind}", "run xacro"}));
}

}  // namespace
}  // namespace ddm
