// Checks a URDF file, and changes what MuJoCo would read in another way than the author meant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "load_model.h"

namespace ddm {

/// Two joints of which one follows the other, as a <mimic> says: q_follower = multiplier q_leader +
/// offset.
struct Coupling {
  std::string follower;
  std::string leader;
  double multiplier = 1.0;
  double offset = 0.0;
};

struct Urdf {
  ModelText model;
  UrdfFacts facts;
  std::vector<Coupling> couplings;  ///< <mimic>
  bool contacts = false;            ///< a <mujoco> block asks for them
};

/// @param path  of the file, from whose folder relative names count
/// @throws std::invalid_argument naming element, value, rule and remedy
Urdf readUrdf(const std::string& text, const std::string& path, const FindPackage& find_package);

}  // namespace ddm
