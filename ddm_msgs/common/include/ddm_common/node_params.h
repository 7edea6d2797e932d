// Converts the parameters of a ROS node to a YAML tree, so that nodes and tools share one reader.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// Converts a value of the parameter server to YAML: doubles exactly, lists, and structs as maps. A
/// string remains a string. ParamReader still parses a string as a number if the key is a number,
/// because rosparam reads `1e-4` in a YAML file as a string.
///
/// @param value  passed by value because its accessors are not const
/// @param name   name of the parameter, for messages
/// @throws std::invalid_argument if the value is a date, binary data or unset
YAML::Node toYaml(XmlRpc::XmlRpcValue value, const std::string& name);

/// Returns the parameters of a node as blocks by name: the text parameter `configuration` in the
/// node's namespace, which all nodes of a launch file share, overlaid with the private parameters
/// of the node.
///
///   ParamReader reader(nodeParams(pnh), pnh.getNamespace());
///
/// @param pnh  private node handle, ros::NodeHandle("~")
/// @return blocks by name; an empty map if there are no parameters
/// @throws std::invalid_argument if `configuration` is not a text of blocks, the node's private
///         namespace holds a value instead of parameters, or a value cannot be written as YAML
YAML::Node nodeParams(const ros::NodeHandle& pnh);

}  // namespace ddm
