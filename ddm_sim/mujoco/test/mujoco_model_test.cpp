// Tests the reading of model files, the messages for invalid files, and the digest.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_model.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "model_folder.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::armText;
using testing::armUrdf;
using testing::kTetrahedron;
using testing::ModelFolder;
using testing::refusalOf;
using testing::replaced;

class MujocoModelTest : public ::testing::Test {
 protected:
  /// Whether loading fails with a message that contains all of these words.
  ::testing::AssertionResult isRefused(const std::string& uri,
                                       const std::vector<std::string>& words) const {
    return testing::names(refusalOf([&] { folder_.load(uri); }), words);
  }

  ModelFolder folder_;
};

TEST_F(MujocoModelTest, FindsPackages) {
  folder_.write("models/arm.xml", armText());
  EXPECT_EQ(folder_.load("package://robots/models/arm.xml")->get().njnt, 2);
  EXPECT_TRUE(isRefused("package://robotz/models/arm.xml", {"plant/model", "robotz"}));
}

TEST_F(MujocoModelTest, NamesAFileThatIsMissingAndTheNearestOne) {
  folder_.write("robot_arm.xml", armText());
  EXPECT_TRUE(isRefused(folder_.path() + "/robot_amr.xml",
                        {"plant/model", "robot_amr.xml", "robot_arm.xml?"}));
  EXPECT_TRUE(isRefused("/nowhere/arm.xml", {"plant/model", "/nowhere/arm.xml"}));
  EXPECT_TRUE(isRefused(folder_.path(), {"plant/model", folder_.path(), "is a folder"}));
  fs::create_symlink("gone.urdf", folder_.path() + "/link.urdf");
  EXPECT_TRUE(isRefused(folder_.path() + "/link.urdf", {"is a link to gone.urdf", "no file"}));
  EXPECT_TRUE(isRefused("/dev/null", {"/dev/null is a pipe or device"}));
  for (int i = 0; i < 12; ++i) folder_.write("a" + std::to_string(i) + ".xml", "");
  EXPECT_TRUE(isRefused(folder_.path() + "/hand.xml", {"there are a0.xml", "and 3 more"}));
  EXPECT_TRUE(isRefused("", {"plant/model"}));
}

TEST_F(MujocoModelTest, NamesTheLineOfABrokenFile) {
  EXPECT_TRUE(isRefused(folder_.write("a.xml", "<mujoco>\n<worldbody>\n</mujoco>"),
                        {"plant/model", "a.xml", "Line number=2"}));
  EXPECT_TRUE(isRefused(folder_.write("c.urdf", "<robot name='x'><link></robot>"),
                        {"plant/model", "c.urdf", "line 1"}));
}

TEST_F(MujocoModelTest, SaysWhatAFileIsThatIsNoModel) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> files = {
      {" \n", {"it is empty"}},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", {"git lfs pull"}},
      {"<!DOCTYPE html>\n<html/>", {"web page", "raw file"}},
      {"PK\x03\x04zip", {"archive", "unzip"}},
      {std::string("\xff\xfe<\0r\0", 6), {"UTF-16", "iconv -f UTF-16"}},
      {"#usda 1.0\n", {"USD", "URDF or MJCF"}},
      {std::string(684, '\0'), {"mesh", "URDF or MJCF file that uses it"}},
      {"<robot name='r'>\n<<<<<<< HEAD\n<link/></robot>", {"line 2", "merge conflict"}},
      {"<!-- made -->\n<?xml version='1.0'?><robot/>", {"line 2", "<?xml must be the first"}},
      {"<robot name='charni\xe8re'/>", {"name in line 1", "UTF-8", "iconv -f LATIN1"}},
      {"<sdf version='1.6'><model/></sdf>", {"<sdf>", "URDF or xacro"}},
      {"<COLLADA/>", {"<collada>", "mesh"}}};
  for (const auto& one : files) {
    EXPECT_TRUE(isRefused(folder_.write("a.urdf", one.first), one.second)) << one.first;
  }
}

TEST_F(MujocoModelTest, SaysWhatHelpsWithAssetsOfAnMjcf) {
  const auto isRefusedWith = [this](const std::string& asset,
                                    const std::vector<std::string>& words) {
    return isRefused(folder_.write("a.xml", armText("<asset>" + asset + "</asset>")), words);
  };
  folder_.write("lfs.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n");
  folder_.write("oak.jpg", "\xff\xd8\xff");
  folder_.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n");
  EXPECT_TRUE(isRefusedWith("<mesh name='m' file='lfs.stl'/>", {"lfs.stl", "git lfs pull"}));
  EXPECT_TRUE(isRefusedWith("<texture name='t' type='2d' file='oak.jpg'/>", {"oak.jpg", "PNG"}));
  const std::string body = "<worldbody><geom type='mesh' mesh='m'/></worldbody>";
  EXPECT_TRUE(isRefused(
      folder_.write("b.xml", armText("<asset><mesh name='m' file='flat.obj'/></asset>" + body)),
      {"plane", "thickness"}));
}

TEST_F(MujocoModelTest, FindsPackagesInIncludesAndSaysFromWherePathsCount) {
  folder_.write("parts/look.xml",
                "<mujocoinclude><asset><mesh name='m' file='gone.stl'/></asset>"
                "</mujocoinclude>");
  const std::string include = "<include file='package://robots/parts/look.xml'/>";
  EXPECT_TRUE(isRefused(folder_.write("robot/a.xml", armText(include)),
                        {"not there: gone.stl", "folder of the model file", "included"}));
  EXPECT_TRUE(isRefused(folder_.write("robot/b.xml", armText("<include file='look.xml'/>")),
                        {"plant/model", "look.xml"}));
  folder_.write("parts/look.xml", "<mujocoinclude><option timestep='0.001'/></mujocoinclude>");
  EXPECT_EQ(folder_.loadText(armText(include), "robot/a.xml")->get().opt.timestep, 0.001);
}

TEST_F(MujocoModelTest, ReadsAUrdfWithItsShapesAndLimitsAndAddsLightButNoContacts) {
  const auto urdf = folder_.loadText(armUrdf(), "arm.urdf");
  const mjModel& model = urdf->get();
  EXPECT_EQ(urdf->names(mjOBJ_JOINT), (std::vector<std::string>{"shoulder", "elbow"}));
  EXPECT_EQ(model.ngeom, 2);
  EXPECT_EQ(urdf->effortLimit("elbow"), 3.0);
  EXPECT_FALSE(urdf->effortLimit("shoulder"));
  EXPECT_NE(model.opt.disableflags & mjDSBL_CONTACT, 0);
  EXPECT_EQ(model.vis.headlight.diffuse[0], 0.6F);
  EXPECT_EQ(folder_.loadText(armText())->get().opt.disableflags & mjDSBL_CONTACT, 0);
}

TEST_F(MujocoModelTest, DrawsNoCollisionShapeOfAUrdfOverAVisualOne) {
  const std::string cylinder =
      "<collision><geometry><cylinder radius='0.2' length='1'/></geometry></collision>";
  const auto drawnCylinders = [&](const char* before) {
    std::string text = armUrdf();
    text.insert(text.rfind(before), cylinder);
    const auto urdf = folder_.loadText(text, "arm.urdf");
    int drawn = 0;
    for (int i = 0; i < urdf->get().ngeom; ++i) {
      drawn += urdf->get().geom_type[i] == mjGEOM_CYLINDER && urdf->get().geom_group[i] < 3 ? 1 : 0;
    }
    return drawn;
  };
  EXPECT_EQ(drawnCylinders("<visual>"), 0);
  EXPECT_EQ(drawnCylinders("</link>"), 1);  // the link has no visual shapes
}

TEST_F(MujocoModelTest, SaysThatAWordMayBeOfANewerMujoco) {
  const std::string version = mj_versionString();
  EXPECT_TRUE(
      isRefused(folder_.write("a.xml", armText("<flexcomp/>")), {version, "element", "later"}));
  EXPECT_TRUE(isRefused(folder_.write("b.xml", armText("<option integrator='implicitfast'/>")),
                        {version, "implicitfast", "later"}));
}

TEST_F(MujocoModelTest, TakesARangeForALimitAsNewerVersionsDo) {
  const std::string text = replaced(armText(), "limited=\"true\" range", "range");
  EXPECT_EQ(folder_.loadText(text)->get().jnt_limited[1], 1);
}

TEST_F(MujocoModelTest, FindsPackagesInMeshesOfAnMjcfButNotInItsComments) {
  folder_.write("meshes/base.obj", kTetrahedron);
  const auto model =
      folder_.loadText(armText("<!-- package://gone/a.obj --><asset><mesh name='m' "
                               "file='package://robots/meshes/base.obj'/></asset>"));
  EXPECT_EQ(model->get().nmesh, 1);
}

TEST_F(MujocoModelTest, RefusesNumbersThatAreNotFinite) {
  const std::string text = replaced(armText(), "damping=\"0.1\"", "damping=\"nan\"");
  EXPECT_TRUE(
      isRefused(folder_.write("a.xml", text), {"plant/model", "not finite", "dof_damping"}));
}

TEST_F(MujocoModelTest, SurvivesWhatCrashesMujoco) {
  // The last vertex of this face does not exist.
  std::string mesh = kTetrahedron;
  mesh.replace(mesh.rfind("2 3 4"), 5, "2 3 400000000");
  folder_.write("base.obj", mesh);
  EXPECT_TRUE(isRefused(folder_.write("a.urdf", armUrdf("base.obj")), {"plant/model", "a.urdf"}));
}

TEST_F(MujocoModelTest, RefusesAModelThatNeedsTooMuchMemory) {
  EXPECT_TRUE(
      isRefused(folder_.write("a.xml", armText("<asset><texture name='t' type='2d' builtin='flat' "
                                               "width='60000' height='60000'/></asset>")),
                {"plant/model", "a.xml"}));
  EXPECT_TRUE(isRefused(folder_.write("b.xml", armText("<size nstack='2000000000'/>")),
                        {"plant/model", "memory", "<size"}));
}

TEST_F(MujocoModelTest, HasADigestOfAllFilesThatItNames) {
  const std::string text = armText(
      "<include file=\"look.xml\"/><compiler meshdir='assets'/>"
      "<asset><mesh name='m' file='base.obj'/></asset>");
  const auto digest = [&](const std::string& look, const std::string& mesh,
                          const std::string& comment) {
    folder_.write("look.xml", look);
    folder_.write("assets/base.obj", mesh);
    return folder_.loadText(text + comment)->digest();
  };
  const std::string look = "<mujocoinclude><visual/></mujocoinclude>";
  const std::string first = digest(look, kTetrahedron, "");
  EXPECT_EQ(digest(look, kTetrahedron, ""), first);
  EXPECT_NE(digest(look, kTetrahedron, "<!-- another word -->"), first);
  EXPECT_NE(digest("<mujocoinclude><size/></mujocoinclude>", kTetrahedron, ""), first);
  EXPECT_NE(digest(look, std::string(kTetrahedron) + "# painted\n", ""), first);
}

}  // namespace
}  // namespace ddm
