// robot_node: parameters, then the node.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_options.h>
#include <ddm_common/run_node.h>

#include "robot_node.h"

namespace {

const ros::WallDuration kLook(0.05);

void run(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, ddm::ParamReader* params) {
  params->ignore("image_transport");    // read by image_transport itself
  params->ignore("diagnostic_period");  // read by diagnostic_updater itself
  const auto image = params->read<ddm::ImageOptions>("image");
  const auto robot = params->read<ddm::RobotOptions>("robot");
  params->requireValid();
  ROS_INFO_STREAM("robot_node runs with\n" << ddm::toYaml(robot));
  ddm::RobotNode node(nh, pnh, image.size, robot);
  ros::AsyncSpinner spinner(4);  // a reset waits in one of them
  spinner.start();
  const auto stop = [&node] {
    node.stopMotors("this node ends");
    return true;
  };
  ddm::runUntilEnd([] { kLook.sleep(); }, stop);
}

}  // namespace

int main(int argc, char** argv) {
  return ddm::runNode("robot_node", argc, argv, run, ddm::Ending::kByLastMessage);
}
