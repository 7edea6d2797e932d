// view_node: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_node/run_node.h>
#include <ddm_params/image_options.h>

#include "view_node.h"

int main(int argc, char** argv) {
  return ddm::runNode("view_node", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
    params->ignore("image_transport");  // read by image_transport itself
    const auto image = params->read<ddm::ImageOptions>("image");
    params->requireValid();
    ROS_INFO_STREAM("view_node runs with\n" << ddm::toYaml(image));
    ddm::ViewNode node(nh, image.size);
    ros::spin();
  });
}
