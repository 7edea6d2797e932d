// Queries which nodes publish a topic and whether publishers and subscribers are connected.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/topic_peers.h"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <boost/algorithm/string/join.hpp>
#include <boost/algorithm/string/predicate.hpp>
#include <chrono>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include "ddm_common/waiting.h"

namespace ddm {
namespace {

using NodesByTopic = std::map<std::string, std::set<std::string>>;
using Connections = std::set<std::pair<std::string, std::string>>;  // topic, subscriber

constexpr std::chrono::seconds kLimit(5);   // because a stopped node never answers
constexpr std::chrono::seconds kEnding(3);  // because a node may still answer while it ends

/// Publishers and subscribers of all topics, according to the master; empty if the master does not
/// answer.
std::optional<std::pair<NodesByTopic, NodesByTopic>> publishersAndSubscribers() {
  std::optional<XmlRpc::XmlRpcValue> state = askMaster("getSystemState", ros::this_node::getName());
  if (!state) return std::nullopt;
  const auto nodesByTopic = [](XmlRpc::XmlRpcValue& list) {
    NodesByTopic out;
    for (int i = 0; i < list.size(); ++i) {
      XmlRpc::XmlRpcValue& nodes = list[i][1];
      for (int j = 0; j < nodes.size(); ++j) {
        out[static_cast<std::string>(list[i][0])].insert(static_cast<std::string>(nodes[j]));
      }
    }
    return out;
  };
  return std::make_pair(nodesByTopic((*state)[0]), nodesByTopic((*state)[1]));
}

/// Calls a method of a node's XML-RPC interface; empty if the node does not answer in time.
std::optional<XmlRpc::XmlRpcValue> askNode(const NodeAddress& node, const std::string& method) {
  const auto ask = [node, method]() -> std::optional<XmlRpc::XmlRpcValue> {
    XmlRpc::XmlRpcValue caller, response;
    caller[0] = ros::this_node::getName();
    // Only the path is given, because the server of rospy does not accept the full URL
    // "http://...".
    XmlRpc::XmlRpcClient* const client = ros::XMLRPCManager::instance()->getXMLRPCClient(
        node.host, static_cast<int>(node.port), "/");
    if (client == nullptr) return std::nullopt;
    const bool answered = client->execute(method.c_str(), caller, response);
    ros::XMLRPCManager::instance()->releaseXMLRPCClient(client);
    return answered ? std::make_optional(response) : std::nullopt;
  };
  return callWithin(kLimit, ask).value_or(std::nullopt);
}

/// Outgoing connections of a node; empty if the node does not answer.
Connections outgoingConnections(const std::string& node) {
  const std::optional<NodeAddress> address = addressOf(node);
  std::optional<XmlRpc::XmlRpcValue> response;
  if (address) response = askNode(*address, "getBusInfo");
  Connections out;
  try {
    if (!response || response->size() != 3) return out;
    for (int i = 0; i < (*response)[2].size(); ++i) {
      // id, destination, direction, transport, topic
      XmlRpc::XmlRpcValue& connection = (*response)[2][i];
      if (static_cast<std::string>(connection[2]) != "o") continue;
      out.emplace(static_cast<std::string>(connection[4]), static_cast<std::string>(connection[1]));
    }
  } catch (const XmlRpc::XmlRpcException&) {  // an answer of unexpected types counts as no answer
    out.clear();
  }
  return out;
}

}  // namespace

std::optional<XmlRpc::XmlRpcValue> askMaster(const std::string& method,
                                             const XmlRpc::XmlRpcValue& request) {
  const auto ask = [method, request]() -> std::optional<XmlRpc::XmlRpcValue> {
    XmlRpc::XmlRpcValue response, payload;
    const bool answered =
        ros::master::execute(method, request, response, payload, /*wait_for_master=*/false);
    return answered ? std::make_optional(payload) : std::nullopt;
  };
  return callWithin(kLimit, ask).value_or(std::nullopt);
}

std::optional<NodeAddress> addressOf(const std::string& node) {
  XmlRpc::XmlRpcValue request;
  request[0] = ros::this_node::getName();
  request[1] = node;
  std::optional<XmlRpc::XmlRpcValue> uri = askMaster("lookupNode", request);
  NodeAddress address;
  if (!uri || !ros::network::splitURI(static_cast<std::string>(*uri), address.host, address.port)) {
    return std::nullopt;
  }
  return address;
}

std::string describePublishers(const std::string& topic) {
  auto nodes = publishersAndSubscribers();
  if (!nodes) return "the ROS master does not answer";
  const std::set<std::string>& publishers = nodes->first[topic];
  if (publishers.empty()) return "nobody publishes " + topic;
  return "publisher(s) of " + topic + ": " + boost::algorithm::join(publishers, ", ");
}

std::string describeImagePublishers(const std::string& topic, const std::string& argument) {
  constexpr char kImage[] = "sensor_msgs/Image";
  constexpr char kCompressed[] = "sensor_msgs/CompressedImage";
  const std::string publishers = describePublishers(topic);
  const auto list_types = [] {
    ros::master::V_TopicInfo topics;  // topics with a publisher
    ros::master::getTopics(topics);
    std::map<std::string, std::string> types;
    for (const ros::master::TopicInfo& each : topics) types[each.name] = each.datatype;
    return types;
  };
  auto types = callWithin(kLimit, list_types).value_or(std::map<std::string, std::string>());
  const auto republish = [&argument](const std::string& base) {
    return ": run `rosrun image_transport republish compressed in:=" + base + " raw out:=" + base +
           "_raw`, and give " + argument + base + "_raw";
  };
  const std::string type = types[topic];
  const std::string suffix = "/compressed";
  if (type.empty() && types[topic + suffix] == kCompressed) {
    return publishers + ", but " + topic + suffix + " is published, as " + kCompressed +
           republish(topic);
  }
  if (type.empty() || type == kImage) return publishers;
  const std::string problem = publishers + ". Its type is " + type + ", and must be " + kImage;
  if (type != kCompressed) {
    return problem + ": give the topic of the camera's images by " + argument + "TOPIC";
  }
  const bool ends = boost::algorithm::ends_with(topic, suffix);
  return problem + republish(topic.substr(0, topic.size() - (ends ? suffix.size() : 0)));
}

std::vector<std::string> missingConnections(const std::vector<std::string>& topics) {
  auto nodes = publishersAndSubscribers();
  if (!nodes) return {"the ROS master does not answer"};
  std::vector<std::string> missing;
  for (const std::string& topic : topics) {
    for (const std::string& publisher : nodes->first[topic]) {
      const Connections connections = outgoingConnections(publisher);
      for (const std::string& subscriber : nodes->second[topic]) {
        if (connections.count({topic, subscriber}) > 0) continue;
        missing.push_back(publisher + " -> " + subscriber + " on " + topic);
      }
    }
  }
  return missing;
}

std::vector<std::string> sharedTopics(const std::vector<std::string>& topics) {
  auto nodes = publishersAndSubscribers();
  if (!nodes) {
    ROS_WARN(
        "the ROS master does not answer: connected nodes keep working, new nodes cannot connect");
    return {};
  }
  std::vector<std::string> shared;
  for (const std::string& topic : topics) {
    std::set<std::string>& publishers = nodes->first[topic];
    publishers.erase(ros::this_node::getName());
    if (publishers.size() < 2) continue;
    shared.push_back(topic + ": " + boost::algorithm::join(publishers, ", "));
  }
  return shared;
}

void requireFreeName() {
  const std::string name = ros::this_node::getName();
  const auto end = std::chrono::steady_clock::now() + kEnding;
  std::optional<NodeAddress> address;
  while ((address = addressOf(name)) && askNode(*address, "getPid")) {
    if (std::chrono::steady_clock::now() > end) {
      throw std::runtime_error(textOf(
          "node ", name, " is running already, at ", address->host, ":", address->port,
          ", and the ROS master would end that one: end its launch first, or set ROS_NAMESPACE or "
          "ROS_MASTER_URI for this one"));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace ddm
