// Fuzz target: values of the parameter server to YAML, to options.
// SPDX-License-Identifier: BSD-3-Clause
//
// Input: a value, one byte for its type, then what the type needs; see draw().
#include <ddm_msgs/testing/fuzzing.h>
#include <ddm_node/node_params.h>
#include <ddm_params/param_value.h>

#include <cmath>

using ddm::testing::accepts;
using ddm::testing::FuzzBytes;
using ddm::testing::require;

namespace {

constexpr int kMaxDepth = 20;

XmlRpc::XmlRpcValue draw(FuzzBytes* bytes, int depth) {
  XmlRpc::XmlRpcValue value;
  switch (bytes->number<std::uint8_t>() % 8) {
    case 0:
      return XmlRpc::XmlRpcValue(bytes->number<std::uint8_t>() % 2 != 0);
    case 1:
      return XmlRpc::XmlRpcValue(bytes->number<int>());
    case 2:
      return XmlRpc::XmlRpcValue(bytes->number<double>());
    case 3:
      return XmlRpc::XmlRpcValue(bytes->text(bytes->number<std::uint8_t>()));
    case 4: {
      const int size = depth < kMaxDepth ? bytes->number<std::uint8_t>() % 8 : 0;
      value.setSize(size);
      for (int i = 0; i < size; ++i) value[i] = draw(bytes, depth + 1);
      return value;
    }
    case 5: {
      const int size = depth < kMaxDepth ? bytes->number<std::uint8_t>() % 8 : 0;
      for (int i = 0; i < size; ++i) {
        const std::string name = bytes->text(bytes->number<std::uint8_t>() % 16);
        value[name] = draw(bytes, depth + 1);
      }
      return value;
    }
    case 6: {
      const std::string binary = bytes->text(bytes->number<std::uint8_t>());
      return XmlRpc::XmlRpcValue(const_cast<char*>(binary.data()), static_cast<int>(binary.size()));
    }
    default:
      return value;  // unset
  }
}

bool isSame(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzBytes bytes(data, size);
  XmlRpc::XmlRpcValue value = draw(&bytes, 0);
  YAML::Node node;
  if (!accepts<std::invalid_argument>([&] { node = ddm::toYaml(value, "/node/sim"); })) return 0;

  double number = 0.0;
  if (value.getType() == XmlRpc::XmlRpcValue::TypeDouble) {
    require(ddm::parseValue(node, &number), "a double reads as one");
    require(isSame(number, static_cast<double&>(value)), "with all its digits");
  }
  int integer = 0;
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt) {
    require(ddm::parseValue(node, &integer), "an integer reads as one");
    require(integer == static_cast<int&>(value), "of the same value");
  }
  std::string text;
  if (value.getType() == XmlRpc::XmlRpcValue::TypeString) {
    require(ddm::parseValue(node, &text), "a text reads as one");
    require(text == static_cast<std::string&>(value), "byte for byte");
  }
  std::vector<double> list;
  ddm::parseValue(node, &list);
  require(node.IsMap() == (value.getType() == XmlRpc::XmlRpcValue::TypeStruct), "a block is a map");
  return 0;
}
