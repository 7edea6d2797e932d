// Whether the publishers and subscribers of a topic have found each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "connections.h"

#include <ddm_node/call_within.h>
#include <ddm_node/topic_peers.h>
#include <ros/console.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <map>
#include <set>

namespace ddm {
namespace {

using Names = std::vector<std::string>;
using Connections = std::set<std::pair<std::string, std::string>>;

constexpr std::chrono::seconds kNodeLimit(5);  // one that was stopped never answers

/// Nodes by topic, from one of the three lists of the master's system state.
std::map<std::string, Names> nodesByTopic(XmlRpc::XmlRpcValue* list) {
  std::map<std::string, Names> out;
  for (int i = 0; i < list->size(); ++i) {
    XmlRpc::XmlRpcValue& nodes = (*list)[i][1];
    Names& names = out[static_cast<std::string>((*list)[i][0])];
    for (int j = 0; j < nodes.size(); ++j) names.push_back(static_cast<std::string>(nodes[j]));
  }
  return out;
}

/// As outgoingConnections(), of the node at this address.
Connections outgoingConnectionsAt(const std::string& host, std::uint32_t port) {
  Connections out;
  XmlRpc::XmlRpcValue caller, response;
  caller[0] = ros::this_node::getName();
  // The path alone: a node in Python does not know the page "http://...".
  XmlRpc::XmlRpcClient* const client =
      ros::XMLRPCManager::instance()->getXMLRPCClient(host, static_cast<int>(port), "/");
  if (client == nullptr) return out;
  if (client->execute("getBusInfo", caller, response) && response.size() == 3) {
    XmlRpc::XmlRpcValue& connections = response[2];
    for (int i = 0; i < connections.size(); ++i) {
      XmlRpc::XmlRpcValue& connection =
          connections[i];  // id, destination, direction, transport, topic
      if (static_cast<std::string>(connection[2]) != "o") continue;
      out.emplace(static_cast<std::string>(connection[4]), static_cast<std::string>(connection[1]));
    }
  }
  ros::XMLRPCManager::instance()->releaseXMLRPCClient(client);
  return out;
}

/// (topic, subscriber) of all outgoing connections of a node; empty if it does not answer.
Connections outgoingConnections(const std::string& node) {
  XmlRpc::XmlRpcValue request;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::optional<XmlRpc::XmlRpcValue> uri = askMaster("lookupNode", request);
  std::string host;
  std::uint32_t port = 0;
  if (!uri || !ros::network::splitURI(static_cast<std::string>(*uri), host, port)) return {};
  return callWithin(kNodeLimit, [host, port] { return outgoingConnectionsAt(host, port); })
      .value_or(Connections());
}

}  // namespace

std::vector<std::string> missingConnections(const std::vector<std::string>& topics) {
  std::optional<XmlRpc::XmlRpcValue> state = askMaster("getSystemState", ros::this_node::getName());
  if (!state) return {"the ROS master does not answer"};
  std::map<std::string, Names> publishers = nodesByTopic(&(*state)[0]);
  std::map<std::string, Names> subscribers = nodesByTopic(&(*state)[1]);
  std::vector<std::string> missing;
  for (const std::string& topic : topics) {
    for (const std::string& publisher : publishers[topic]) {
      const auto connections = outgoingConnections(publisher);
      for (const std::string& subscriber : subscribers[topic]) {
        if (connections.count({topic, subscriber}) > 0) continue;
        missing.push_back(publisher + " -> " + subscriber + " on " + topic);
      }
    }
  }
  return missing;
}

std::vector<std::string> sharedTopics(const std::vector<std::string>& topics) {
  std::optional<XmlRpc::XmlRpcValue> state = askMaster("getSystemState", ros::this_node::getName());
  if (!state) {
    ROS_WARN("the ROS master does not answer: nodes that know each other go on, nobody new comes");
    return {};
  }
  std::map<std::string, Names> publishers = nodesByTopic(&(*state)[0]);
  std::vector<std::string> shared;
  for (const std::string& topic : topics) {
    Names& names = publishers[topic];
    names.erase(std::remove(names.begin(), names.end(), ros::this_node::getName()), names.end());
    if (names.size() < 2) continue;
    std::sort(names.begin(), names.end());
    shared.push_back(topic + ": " + boost::algorithm::join(names, ", "));
  }
  return shared;
}

}  // namespace ddm
