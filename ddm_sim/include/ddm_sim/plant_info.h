// What a plant says of itself; columns, limits, units and success follow from it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

enum class JointKind { kAngle, kLength };

struct Joint {
  std::string name;  ///< in ground_truth/joint_states
  JointKind kind = JointKind::kAngle;
};

struct PlantInfo {
  std::string type = "of a test";  ///< plant/type, for messages; makePlant() fills it in

  std::vector<Joint> joints;  ///< in the order of their positions in the state

  /// Components of a state with their units, the headers of CSV files: "angle_rad". Positions come
  /// first, one for each joint, then their rates if the plant has them.              [stateDim()]
  std::vector<std::string> state_names;

  std::vector<std::string> torque_names;  ///< the same for a torque: "torque_nm"  [torqueDim()]
  Eigen::VectorXd max_torque;  ///< bound on each |u|, in the unit of its name [torqueDim() x 1]
  double dt = 0.2;             ///< time step [s]
  Eigen::VectorXd start;       ///< middle of the start states                 [stateDim() x 1]
  Eigen::VectorXd start_std;   ///< standard deviation of each component       [stateDim() x 1]
  Eigen::VectorXd goal;        ///< state to reach and hold                    [stateDim() x 1]
  std::string error_unit;      ///< unit of Plant::goalError(): "deg", "m", "px"
  double tolerance = 0.0;      ///< the goal is reached where goalError() is at most this
  int evaluation_steps = 0;    ///< time steps of a greedy run; 0: as many as a trial has

  int stateDim() const { return static_cast<int>(state_names.size()); }
  int torqueDim() const { return static_cast<int>(torque_names.size()); }
};

}  // namespace ddm
