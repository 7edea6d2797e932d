// What to read from a bag. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Block `data_set`.
struct BagOptions {
  std::string image_topic = "camera/image_raw";  ///< sensor_msgs/Image
  std::string torque_topic = "torque";           ///< ddm_msgs/Torque
  std::string goal_topic = "goal_image";         ///< sensor_msgs/Image, may be missing in the bag

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("image_topic", image_topic);
    visitor("torque_topic", torque_topic);
    visitor("goal_topic", goal_topic);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

}  // namespace ddm
