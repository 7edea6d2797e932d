// model_node: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/solver_log.h>
#include <ddm_node/run_node.h>

#include "model_node.h"

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  return ddm::runNode("model_node", argc, argv, [](auto nh, auto pnh, ddm::ParamReader* params) {
    params->ignore("diagnostic_period");  // read by diagnostic_updater itself
    const ddm::ModelConfig config = ddm::readModelConfig(params);
    const auto access = params->read<ddm::BagAccess>("access");
    params->requireValid();
    ROS_INFO_STREAM("model_node runs with\n" << ddm::toText(config));
    ddm::ModelNode node(nh, pnh, config, access);
    ros::spin();
  });
}
