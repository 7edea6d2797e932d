// mpc_node: reads its parameters and runs the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_options.h>
#include <ddm_common/run_node.h>
#include <ddm_model/minimise.h>

#include "mpc_node.h"

namespace {

void run(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, ddm::ParamReader* params) {
  params->ignore("image_transport");    // image_transport reads it
  params->ignore("diagnostic_period");  // diagnostic_updater reads it
  const auto image = params->read<ddm::ImageOptions>("image");
  const auto mpc = params->read<ddm::MpcOptions>("mpc");
  const auto controller = params->read<ddm::ControllerOptions>("controller");
  params->requireValid();
  ROS_INFO_STREAM("mpc_node runs with\n" << ddm::toYaml(mpc) << "\n" << ddm::toYaml(controller));
  ddm::MpcNode node(nh, pnh, image.size, mpc, controller);
  ros::spin();
}

}  // namespace

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  return ddm::runNode("mpc_node", argc, argv, run);
}
