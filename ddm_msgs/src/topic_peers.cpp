// Who is at the other end of a topic, for messages that name the silent side.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_msgs/topic_peers.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace ddm {

std::string describePublishers(const std::string& topic) {
  XmlRpc::XmlRpcValue response;
  XmlRpc::XmlRpcValue system_state;
  if (!ros::master::execute("getSystemState", ros::this_node::getName(), response, system_state,
                            /*wait_for_master=*/false)) {
    return "the ROS master does not answer";
  }
  std::string names;
  XmlRpc::XmlRpcValue& published = system_state[0];
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string>(published[i][0]) != topic) continue;
    for (int j = 0; j < published[i][1].size(); ++j) {
      names += (names.empty() ? "" : ", ") + static_cast<std::string>(published[i][1][j]);
    }
  }
  return names.empty() ? "nobody publishes " + topic : "publisher(s) of " + topic + ": " + names;
}

}  // namespace ddm
