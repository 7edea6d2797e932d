// What the camera shows of a plant, where no topic lies between the two.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>
#include <ddm_msgs/image_codec.h>
#include <ddm_sim/plant.h>

namespace ddm {

/// The message that sim_node would publish of a state.
inline sensor_msgs::Image photograph(const Plant& plant, const Eigen::VectorXd& state,
                                     const ros::Time& stamp) {
  return encodeImage(plant.render(state), plant.imageSize(), stamp, "camera");
}

/// The same as a learner sees it, through the codec that bags and nodes use.
/// @param image_size  `image/size` [pixels]
inline Grey cameraView(const Plant& plant, int image_size) {
  return decodeImage(photograph(plant, plant.state(), ros::Time()), image_size);
}

}  // namespace ddm
