// trial_recorder: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_node/run_node.h>

#include "trial_recorder.h"

int main(int argc, char** argv) {
  return ddm::runNode("trial_recorder", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
    const auto bag = params->read<ddm::BagOptions>("data_set");
    const auto access = params->read<ddm::BagAccess>("access");
    const auto options = params->read<ddm::RecorderOptions>("recorder");
    params->requireValid();
    ddm::TrialRecorder recorder(nh, bag, access, options);
    ros::MultiThreadedSpinner(2).spin();
  });
}
