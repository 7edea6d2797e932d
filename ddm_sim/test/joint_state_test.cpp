// Tests of the JointState message of a plant: each array is empty or as long as the names.
// SPDX-License-Identifier: BSD-3-Clause
#include "joint_state.h"

#include <gtest/gtest.h>

#include "ddm_plant_plugin/testing/toy_plant.h"
#include "ddm_sim/moving_tile.h"

namespace ddm {
namespace {

using Names = std::vector<std::string>;
using Numbers = std::vector<double>;
using testing::ToyPlant;

Eigen::VectorXd numbers(const Numbers& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// The message of a toy plant with these joints, names and motors in the state 1, 2, 3, ...
sensor_msgs::JointState toyState(const Names& joints, const Names& states, const Names& torques) {
  ToyPlant::Traits traits;
  const auto dim = static_cast<Eigen::Index>(states.size());
  traits.info.start = Eigen::VectorXd::LinSpaced(dim, 1.0, static_cast<double>(dim));
  traits.info.joints.clear();
  for (const std::string& joint : joints) traits.info.joints.push_back({joint, JointKind::kAngle});
  traits.info.state_names = states;
  traits.info.torque_names = torques;
  const Eigen::VectorXd applied = Eigen::VectorXd::Constant(traits.info.torqueDim(), 0.5);
  return jointStateOf(ToyPlant(traits), applied);
}

TEST(JointState, OfATileHasTwoPositionsTwoEffortsAndNoVelocity) {
  MovingTile plant{MovingTileOptions()};
  plant.setState(Eigen::Vector2d(10.0, 20.0));
  const sensor_msgs::JointState out = jointStateOf(plant, numbers({1.0, -1.0}));
  EXPECT_EQ(out.name, (Names{"x", "y"}));
  EXPECT_EQ(out.position, (Numbers{10.0, 20.0}));
  EXPECT_TRUE(out.velocity.empty());
  EXPECT_EQ(out.effort, (Numbers{1.0, -1.0}));
}

TEST(JointState, HasNoEffortWhereMotorsAreNotAsManyAsJoints) {
  const auto out = toyState({"shoulder", "elbow"},
                            {"shoulder_rad", "elbow_rad", "shoulder_rad_per_s", "elbow_rad_per_s"},
                            {"elbow_nm"});
  EXPECT_EQ(out.name, (Names{"shoulder", "elbow"}));
  EXPECT_EQ(out.position, (Numbers{1.0, 2.0}));
  EXPECT_EQ(out.velocity, (Numbers{3.0, 4.0}));
  EXPECT_TRUE(out.effort.empty());
}

TEST(JointState, KeepsTheWholeStateWhereThereIsMoreThanPositionsAndRates) {
  const auto out = toyState({"arm"}, {"angle_rad", "rate_rad_per_s", "current_a"}, {"voltage_v"});
  EXPECT_EQ(out.name, (Names{"arm", "rate_rad_per_s", "current_a"}));
  EXPECT_EQ(out.position, (Numbers{1.0, 2.0, 3.0}));
  EXPECT_TRUE(out.velocity.empty());
  EXPECT_TRUE(out.effort.empty());
}

}  // namespace
}  // namespace ddm
