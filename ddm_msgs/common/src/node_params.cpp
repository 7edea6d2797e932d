// Converts the parameters of a ROS node to a YAML tree.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/node_params.h"

#include <ros/names.h>
#include <ros/param.h>

#include <stdexcept>

#include "ddm_common/config_blocks.h"
#include "ddm_common/param_value.h"

namespace ddm {
YAML::Node toYaml(XmlRpc::XmlRpcValue value, const std::string& name) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      return valueToYaml(static_cast<bool&>(value));
    case XmlRpc::XmlRpcValue::TypeInt:
      return valueToYaml(static_cast<int&>(value));
    case XmlRpc::XmlRpcValue::TypeDouble:
      return valueToYaml(static_cast<double&>(value));
    case XmlRpc::XmlRpcValue::TypeString:
      return valueToYaml(static_cast<std::string&>(value));
    case XmlRpc::XmlRpcValue::TypeArray: {
      YAML::Node out(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) {
        out.push_back(toYaml(value[i], name + "[" + std::to_string(i) + "]"));
      }
      out.SetStyle(YAML::EmitterStyle::Flow);
      return out;
    }
    case XmlRpc::XmlRpcValue::TypeStruct: {
      YAML::Node out(YAML::NodeType::Map);
      for (auto& member : value) {
        out[member.first] = toYaml(member.second, name + "/" + member.first);
      }
      return out;
    }
    default:
      throw std::invalid_argument("parameter " + name +
                                  " must be a number, a text, true or false, a list or a block");
  }
}

YAML::Node nodeParams(const ros::NodeHandle& pnh) {
  // a std::string, because a char pointer would be converted to bool
  const std::string name = "configuration";
  const std::string shared =
      ros::names::resolve(ros::names::parentNamespace(pnh.getNamespace()), name);
  YAML::Node params(YAML::NodeType::Map);
  std::string text;
  if (ros::param::get(shared, text)) {
    params = parseBlocks(text, "parameter " + shared);
  } else if (ros::param::has(shared)) {
    throw std::invalid_argument("parameter " + shared +
                                " must be the text of a configuration, as the launch files of "
                                "ddm_launch set it: delete it, or start this node elsewhere");
  }
  XmlRpc::XmlRpcValue value;
  if (!ros::param::get(pnh.getNamespace(), value)) return params;
  if (value.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    throw std::invalid_argument("parameter " + pnh.getNamespace() +
                                " must be the namespace of a node's parameters, not a value");
  }
  overlay(toYaml(value, pnh.getNamespace()), &params);
  return params;
}

}  // namespace ddm
