// model_node: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/solver_log.h>
#include <ddm_node/node_params.h>
#include <ddm_params/param_reader.h>

#include <cstdlib>

#include "model_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "model_node");
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");  // outside the try: its destructor shuts the log down
  ddm::silenceSolverLog();
  try {
    ddm::ParamReader params(ddm::nodeParams(pnh), pnh.getNamespace());
    params.ignore("diagnostic_period");  // read by diagnostic_updater itself
    const ddm::ModelConfig config = ddm::readModelConfig(&params);
    const auto access = params.read<ddm::BagAccess>("access");
    params.requireValid();
    ROS_INFO_STREAM("model_node runs with\n" << ddm::toText(config));
    ddm::ModelNode node(nh, pnh, config, access);
    ros::spin();
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("model_node: " << e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
