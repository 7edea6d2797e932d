// view_node: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_node/node_params.h>
#include <ddm_params/image_options.h>
#include <ddm_params/param_reader.h>

#include <cstdlib>

#include "view_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "view_node");
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");  // outside the try: its destructor shuts the log down
  try {
    ddm::ParamReader params(ddm::nodeParams(pnh), pnh.getNamespace());
    params.ignore("image_transport");  // read by image_transport itself
    const auto image = params.read<ddm::ImageOptions>("image");
    params.requireValid();
    ROS_INFO_STREAM("view_node runs with\n" << ddm::toYaml(image));
    ddm::ViewNode node(nh, image.size);
    ros::spin();
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("view_node: " << e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
