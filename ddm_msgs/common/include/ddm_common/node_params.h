// Parameters of a ROS node as a YAML tree, so that nodes and tools share one reader.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// One value of the parameter server as YAML: exact doubles, lists, and structs as maps. A text
/// stays a text; ParamReader still reads a number from it where a number is due, because rosparam
/// takes `1e-4` in a YAML file for a text.
///
/// @param value  by value: its accessors are not const
/// @param name   of the parameter, for messages
/// @throws std::invalid_argument if the value is a date, binary data or unset
YAML::Node toYaml(XmlRpc::XmlRpcValue value, const std::string& name);

/// The parameters of a node, blocks by name: those of the text parameter `configuration` in the
/// node's namespace, which all nodes of a launch share, and over them the node's private ones.
///
///   ParamReader reader(nodeParams(pnh), pnh.getNamespace());
///
/// @param pnh  private node handle, ros::NodeHandle("~")
/// @return an empty map if there are none
/// @throws std::invalid_argument if `configuration` is not a text of blocks, the node's own name
///         holds a value instead of parameters, or a value cannot be written as YAML
YAML::Node nodeParams(const ros::NodeHandle& pnh);

}  // namespace ddm
