// Who is at the other end of a topic, for messages that name the silent side.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_node/topic_peers.h"

#include <ros/master.h>
#include <ros/this_node.h>

#include "ddm_node/call_within.h"

namespace ddm {
namespace {

constexpr std::chrono::seconds kMasterLimit(5);

}  // namespace

std::optional<XmlRpc::XmlRpcValue> askMaster(const std::string& method,
                                             const XmlRpc::XmlRpcValue& request) {
  const auto answer = callWithin(kMasterLimit, [method, request] {
    XmlRpc::XmlRpcValue response;
    std::optional<XmlRpc::XmlRpcValue> payload(std::in_place);
    if (!ros::master::execute(method, request, response, *payload, /*wait_for_master=*/false)) {
      payload.reset();
    }
    return payload;
  });
  return answer ? *answer : std::nullopt;
}

std::string describePublishers(const std::string& topic) {
  std::optional<XmlRpc::XmlRpcValue> system_state =
      askMaster("getSystemState", ros::this_node::getName());
  if (!system_state) return "the ROS master does not answer";
  std::string names;
  XmlRpc::XmlRpcValue& published = (*system_state)[0];
  for (int i = 0; i < published.size(); ++i) {
    if (static_cast<std::string>(published[i][0]) != topic) continue;
    for (int j = 0; j < published[i][1].size(); ++j) {
      names += (names.empty() ? "" : ", ") + static_cast<std::string>(published[i][1][j]);
    }
  }
  return names.empty() ? "nobody publishes " + topic : "publisher(s) of " + topic + ": " + names;
}

}  // namespace ddm
