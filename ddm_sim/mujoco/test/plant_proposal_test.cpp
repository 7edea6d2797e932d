// Tests the proposal of plant options for a model file.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/plant_proposal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_mujoco/mujoco_plant.h"
#include "ddm_sim/plant.h"
#include "model_files.h"
#include "model_folder.h"

namespace ddm {
namespace {

using testing::ModelFolder;
using Texts = std::vector<std::string>;

/// A rod of 1 m and 1 kg that hangs below its joint at position 0.
std::string rodLink(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><origin xyz='0 0 -0.5'/><mass value='1'/><inertia ixx='0.083' iyy='0.083' "
         "izz='0.002' ixy='0' ixz='0' iyz='0'/></inertial><visual><origin xyz='0 0 "
         "-0.5'/><geometry>"
         "<box size='0.1 0.1 1'/></geometry></visual></link>";
}

std::string jointOf(const std::string& name, const std::string& type, const std::string& parent,
                    const std::string& child, const std::string& axis, const std::string& limit) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
         "'/><child link='" + child + "'/><axis xyz='" + axis + "'/><dynamics damping='0.1'/>" +
         limit + "</joint>";
}

std::string robot(const std::string& parts) {
  return "<robot name='r'><link name='base'/>" + parts + "</robot>";
}

std::string pendulum(const std::string& limit, const std::string& axis = "0 1 0") {
  return robot(rodLink("rod") + jointOf("hinge", "continuous", "base", "rod", axis, limit));
}

/// A cart on a rail of 2 m along x, with a pole on the cart.
std::string cartPole() {
  return robot(
      "<link name='cart'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' "
      "ixy='0' ixz='0' iyz='0'/></inertial><visual><geometry><box size='0.3 0.2 0.1'/>"
      "</geometry></visual></link>" +
      rodLink("pole") +
      jointOf("rail", "prismatic", "base", "cart", "1 0 0",
              "<limit lower='-1' upper='1' effort='9' velocity='1'/>") +
      jointOf("pivot", "continuous", "cart", "pole", "0 1 0", ""));
}

class Proposal : public ::testing::Test {
 protected:
  /// @param text  MJCF or URDF
  PlantProposal propose(const std::string& text) {
    const bool is_mjcf = text.rfind("<mujoco>", 0) == 0;
    model_ = folder_.loadText(text, is_mjcf ? "robot.xml" : "robot.urdf");
    return proposePlant(model_, {}, {});
  }

  ModelFolder folder_;
  std::shared_ptr<const MujocoModel> model_;
};

Eigen::Vector3d viewOf(const PlantProposal& proposal) {
  const RenderOptions& look = proposal.options.look;
  const Eigen::Vector3d position(look.position.data()), at(look.look_at.data());
  return (at - position).normalized();
}

/// Whether the edge of the image shows only the black background, so that the image contains the
/// whole robot.
bool showsAll(const MujocoPlant& plant, const Eigen::VectorXd& pose) {
  const RenderedImage rendered = plant.render(pose);
  int brightest = 0;
  for (int i = 0; i < rendered.width; ++i) {
    for (const int pixel : {i, (rendered.height - 1) * rendered.width + i, i * rendered.width,
                            i * rendered.width + rendered.width - 1}) {
      brightest = std::max<int>(brightest, rendered.bytes[static_cast<std::size_t>(pixel)]);
    }
  }
  return brightest == 0;
}

TEST_F(Proposal, MotorsAreTheTransmissionsOfAUrdfThenItsJointsWithAnEffortLimit) {
  const std::string strong = "<limit effort='5' velocity='1'/>",
                    weak = "<limit effort='0' velocity='1'/>";
  const auto two = [](const std::string& upper, const std::string& lower, const std::string& more) {
    return robot(rodLink("a") + rodLink("b") +
                 jointOf("upper", "continuous", "base", "a", "0 1 0", upper) +
                 jointOf("lower", "continuous", "a", "b", "0 1 0", lower) + more);
  };
  const std::string mimic = "<mimic joint='upper'/>";
  const std::string transmission = "<transmission name='t'><joint name='lower'/></transmission>";
  const std::pair<std::string, Texts> cases[] = {
      {two(strong, weak, ""), {"upper"}},
      {two(strong, strong, ""), {"upper", "lower"}},
      {two(strong, weak, transmission), {"lower"}},
      {two(strong, strong + mimic, ""), {"upper"}},
      {two(weak, weak + mimic, ""), {"upper"}},  // the other joint mimics this one
      {pendulum(""), {"hinge"}}};
  for (const auto& one : cases) EXPECT_EQ(propose(one.first).motors, one.second) << one.first;
  EXPECT_TRUE(testing::names(testing::refusalOf([&] { propose(two(weak, weak, "")); }),
                             {"--motors", "upper,lower"}));
}

TEST_F(Proposal, MotorsOfAnMjcfFileAreItsActuatorsAndServosBecomeTorques) {
  const auto arm = [](const std::string& actuator) {
    return "<mujoco><worldbody><body><joint name='swing' axis='0 1 0'/><geom type='capsule' "
           "size='.05 .4'/></body></worldbody><actuator>" +
           actuator + "</actuator></mujoco>";
  };
  const PlantProposal motor =
      propose(arm("<motor joint='swing' ctrllimited='true' ctrlrange='-1 1'/>"));
  EXPECT_EQ(motor.options.motors, Texts());
  EXPECT_EQ(motor.motors, Texts({"swing"}));
  const PlantProposal servo = propose(arm("<position joint='swing' kp='10'/>"));
  EXPECT_EQ(servo.options.motors, Texts({"swing"}));
}

TEST_F(Proposal, APendulumStartsHangingAndItsGoalIsUpright) {
  const PlantProposal proposal = propose(pendulum("<limit effort='5' velocity='1'/>"));
  EXPECT_EQ(proposal.options.start, std::vector<double>({0.0}));
  EXPECT_NEAR(std::abs(proposal.options.goal.at(0)), kPi, 1e-12);
  EXPECT_EQ(proposal.to_set, std::set<std::string>({"goal", "tolerance"}));
}

TEST_F(Proposal, ATorqueIsEstimatedFromTheWeightWhereTheFileHasNoLimitOrAHugeOne) {
  for (const char* limit :
       {"", "<limit effort='0' velocity='1'/>", "<limit effort='1000' velocity='1'/>"}) {
    const PlantProposal proposal = propose(pendulum(limit));
    EXPECT_GT(proposal.options.max_torque.at(0), 9.81 * 0.5) << limit;
    EXPECT_LT(proposal.options.max_torque.at(0), 20.0) << limit;
    EXPECT_NE(proposal.reasons.at("max_torque").find("estimated"), std::string::npos) << limit;
  }
  EXPECT_EQ(propose(pendulum("<limit effort='5' velocity='1'/>")).options.max_torque,
            std::vector<double>({5.0}));
}

TEST_F(Proposal, ATorqueRangeInOneDirectionIsQuoted) {
  const PlantProposal proposal = propose(
      "<mujoco><worldbody><body><joint name='swing' axis='0 1 0' damping='.1'/><geom "
      "type='capsule' size='.05' fromto='0 0 0 0 0 -.5'/></body></worldbody><actuator><motor "
      "joint='swing' ctrllimited='true' ctrlrange='0 30'/></actuator></mujoco>");
  EXPECT_NE(proposal.reasons.at("max_torque").find("torques [0, 30]"), std::string::npos);
}

TEST_F(Proposal, ATorqueThatMakesAJointFasterThanAFallIsLoweredAndMarked) {
  const std::string friction = pendulum("<limit effort='8' velocity='1'/>", "0 0 1");
  const PlantProposal proposal =
      propose(testing::replaced(friction, " damping=", " friction='2' damping="));
  EXPECT_LT(proposal.options.max_torque.at(0), 8.0);
  EXPECT_EQ(proposal.to_set, std::set<std::string>({"goal", "max_torque", "tolerance"}));
  EXPECT_NE(proposal.reasons.at("max_torque").find("lowered"), std::string::npos);
}

TEST_F(Proposal, ATorqueIsNotLoweredBecauseASmallRobotFallsFast) {
  const std::string rod = "<geom type='capsule' size='.002' fromto='0 0 0 0 0 -.03' mass='.01'/>";
  const PlantProposal proposal = propose(
      "<mujoco><option timestep='.0005'><flag contact='disable'/></option><worldbody><body><joint "
      "name='shoulder' axis='0 1 0'/>" +
      rod + "<body pos='0 0 -.03'><joint name='elbow' axis='0 1 0'/>" + rod +
      "</body></body></worldbody><actuator><motor joint='shoulder'/><motor "
      "joint='elbow'/></actuator></mujoco>");
  EXPECT_GT(proposal.options.max_torque.at(0), 9.81 * 0.01 * (0.015 + 0.045));
  EXPECT_GT(proposal.options.max_torque.at(1), 9.81 * 0.01 * 0.015);
}

TEST_F(Proposal, ANarrowHingeIsNotSolvedAtTheStartAndStartsWithinItsLimits) {
  const auto hinge = [](const std::string& name, const std::string& more) {
    return jointOf(name, "revolute", "base", name + "_rod", "0 0 1",
                   "<limit lower='-0.1' upper='0.1' effort='2' velocity='1'/>" + more);
  };
  const MujocoOptions options =
      propose(robot(rodLink("flap_rod") + rodLink("other_rod") + hinge("flap", "") +
                    hinge("other", "<mimic joint='flap'/>")))
          .options;
  const double way = (options.goal[0] - options.start[0]) * 180.0 / kPi;
  EXPECT_NEAR(std::abs(way), 2.9, 0.1);  // a quarter of the range
  EXPECT_LT(options.tolerance, 0.3 * std::abs(way));
  EXPECT_EQ(options.start_std, std::vector<double>({0.01, 0.0, 0.01, 0.0}));
}

TEST_F(Proposal, AVerticalSlideNeedsLimits) {
  const std::string lift =
      "<mujoco><worldbody><body><joint name='lift' type='slide' axis='0 0 1'/><geom type='box' "
      "size='.1 .1 .1'/></body></worldbody><actuator><motor joint='lift'/></actuator></mujoco>";
  EXPECT_TRUE(testing::names(testing::refusalOf([&] { propose(lift); }),
                             {"lift", "falls without end", "range"}));
}

TEST_F(Proposal, NeitherStartNorGoalIsInsideATable) {
  const PlantProposal proposal = propose(
      "<mujoco><worldbody><geom type='plane' size='1 1 .1'/><body pos='0 0 .1'><joint "
      "name='shoulder' axis='0 1 0' range='-120 120' damping='.2'/><geom type='capsule' "
      "fromto='0 0 0 0 0 .3' size='.025'/></body></worldbody><actuator><motor joint='shoulder' "
      "ctrlrange='-6 6'/></actuator></mujoco>");
  const DataPointer data = makeData(model_->get());
  for (const std::vector<double>& pose : {proposal.options.start, proposal.options.goal}) {
    data->qpos[0] = pose[0];
    mj_forward(&model_->get(), data.get());
    for (int i = 0; i < data->ncon; ++i) EXPECT_GT(data->contact[i].dist, -1e-3) << pose[0];
  }
}

TEST_F(Proposal, AMotorLiftsTheJointsThatFollowIts) {
  const auto finger = [](const std::string& name, const std::string& more) {
    return rodLink(name + "_rod") +
           jointOf(name, "continuous", "base", name + "_rod", "0 1 0", more);
  };
  const PlantProposal proposal =
      propose(robot(finger("a", "") + finger("b", "<mimic joint='a'/>")));
  EXPECT_GT(proposal.options.max_torque.at(0), 1.5 * 2.0 * 9.81 * 0.5);
}

TEST_F(Proposal, AJointMayMimicOneThatMimicsAThird) {
  const auto finger = [](const std::string& name, const std::string& parent,
                         const std::string& leader) {
    return rodLink(name + "_rod") +
           jointOf(name, "continuous", parent, name + "_rod", "0 1 0",
                   leader.empty() ? "" : "<mimic joint='" + leader + "'/>");
  };
  const PlantProposal proposal = propose(
      robot(finger("a", "base", "") + finger("b", "a_rod", "c") + finger("c", "b_rod", "a")));
  for (const Eigen::VectorXd& pose : proposal.poses) EXPECT_EQ(pose[1], pose[0]);
}

TEST_F(Proposal, TheCameraLooksAlongTheAxesOfParallelHinges) {
  for (const char* axis : {"0 1 0", "0 -1 0", "1 0 0", "0.6 0.8 0"}) {
    const PlantProposal proposal = propose(pendulum("", axis));
    double x = 0.0, y = 0.0, z = 0.0;
    std::istringstream(axis) >> x >> y >> z;
    EXPECT_GT(std::abs(viewOf(proposal).dot(Eigen::Vector3d(x, y, z))), 0.99) << axis;
  }
  const PlantProposal proposal = propose(cartPole());
  EXPECT_GT(std::abs(viewOf(proposal).y()), 0.99);
}

TEST_F(Proposal, AllPosesAreInTheImage) {
  const PlantProposal proposal = propose(cartPole());
  MujocoPlant plant(model_, proposal.options);
  std::vector<Eigen::VectorXd> poses = proposal.poses;
  for (const double x : {-1.0, 1.0}) {
    for (int k = 0; k < 8; ++k) poses.push_back(Eigen::Vector4d(x, k * kPi / 4.0, 0.0, 0.0));
  }
  for (const Eigen::VectorXd& pose : poses) EXPECT_TRUE(showsAll(plant, pose)) << pose.transpose();
}

TEST_F(Proposal, SpringsPullTheStartWhereTheyAreAtRest) {
  const PlantProposal proposal = propose(
      "<mujoco><option gravity='0 0 0'/><worldbody><body><joint name='swing' axis='0 1 0' "
      "stiffness='50' springref='60'/><geom type='capsule' size='.05' fromto='0 0 0 0 0 -.5'/>"
      "</body></worldbody><actuator><motor joint='swing'/></actuator></mujoco>");
  EXPECT_NEAR(proposal.options.start.at(0), kPi / 3.0, 0.01);
  // 4 N m would move the link without the spring.
  EXPECT_GT(proposal.options.max_torque.at(0), 20.0);
}

TEST_F(Proposal, ARailBesideAHingeDoesNotCountBecauseDegreesAndMetresCannotBeCompared) {
  const PlantProposal proposal = propose(cartPole());
  EXPECT_NE(proposal.reasons.at("tolerance").find("of rail do not count"), std::string::npos);
  MujocoPlant plant(model_, proposal.options);
  EXPECT_GT(checkPlant(proposal, plant).changed_pixels, 25);  // of 2601 pixels
}

TEST_F(Proposal, TheCheckNamesAJointThatTheImageDoesNotShow) {
  const PlantProposal proposal = propose(
      "<mujoco><worldbody><body><joint name='swing' axis='0 1 0'/><geom type='capsule' size='.05' "
      "fromto='0 0 0 0 0 -.5'/><body pos='0 0 -.5'><joint name='wheel' axis='0 1 0'/><geom "
      "type='cylinder' size='.2 .05' zaxis='0 1 0'/></body></body></worldbody><actuator><motor "
      "joint='wheel' ctrllimited='true' ctrlrange='-1 1'/></actuator></mujoco>");
  MujocoPlant plant(model_, proposal.options);
  EXPECT_EQ(checkPlant(proposal, plant).unseen, Texts({"wheel"}));
}

}  // namespace
}  // namespace ddm
