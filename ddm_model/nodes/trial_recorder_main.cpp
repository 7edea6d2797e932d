// trial_recorder: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_node/node_params.h>
#include <ddm_params/param_reader.h>

#include <cstdlib>

#include "trial_recorder.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "trial_recorder");
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");  // outside the try: its destructor shuts the log down
  try {
    ddm::ParamReader params(ddm::nodeParams(pnh), pnh.getNamespace());
    const auto bag = params.read<ddm::BagOptions>("data_set");
    const auto access = params.read<ddm::BagAccess>("access");
    const auto options = params.read<ddm::RecorderOptions>("recorder");
    params.requireValid();
    ddm::TrialRecorder recorder(nh, bag, access, options);
    ros::MultiThreadedSpinner(2).spin();
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("trial_recorder: " << e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
