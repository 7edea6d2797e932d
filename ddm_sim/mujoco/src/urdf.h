// Checks a URDF file and rewrites the parts that MuJoCo would misread.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "load_model.h"

namespace ddm {

/// Two coupled joints (<mimic>):
///
///   q_follower = multiplier q_leader + offset
struct Coupling {
  std::string follower;
  std::string leader;
  double multiplier = 1.0;
  double offset = 0.0;
};

struct Urdf {
  ModelText model;
  UrdfFacts facts;
  std::vector<Coupling> couplings;  ///< from the <mimic> elements
  bool contacts = false;            ///< true: a <mujoco> block asks for contacts
};

/// @param path  path of the file; relative names count from its folder
/// @throws std::invalid_argument naming element, value, rule and remedy
Urdf readUrdf(const std::string& text, const std::string& path, const FindPackage& find_package);

}  // namespace ddm
