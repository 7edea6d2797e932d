// Tests of node parameters as YAML: the conversion, and reading from the parameter server.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/node_params.h"

#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/init.h>

#include <ctime>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_common/param_reader.h"

namespace ddm {
namespace {

struct MpcOptions {
  int horizon = 0;
  double epsilon = 0.0;
  double max_torque = 0.0;
  bool warm_start = true;
  std::string goal_image;
  std::vector<int> starts;
  std::vector<double> start_scale;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("horizon", horizon);
    visitor("epsilon", epsilon);
    visitor("max_torque", max_torque);
    visitor("warm_start", warm_start);
    visitor("goal_image", goal_image);
    visitor("starts", starts);
    visitor("start_scale", start_scale);
  }
  std::vector<std::string> problems() const { return {}; }
};

TEST(XmlRpcToYaml, ConvertsEveryScalar) {
  EXPECT_EQ(toYaml(XmlRpc::XmlRpcValue(15), "p").Scalar(), "15");
  EXPECT_EQ(toYaml(XmlRpc::XmlRpcValue(true), "p").Scalar(), "true");
  EXPECT_EQ(toYaml(XmlRpc::XmlRpcValue(0.1 + 0.2), "p").Scalar(), "0.30000000000000004");
  EXPECT_EQ(toYaml(XmlRpc::XmlRpcValue("1e-4"), "p").Scalar(), "1e-4");
}

TEST(XmlRpcToYaml, ConvertsNestedListsAndStructs) {
  XmlRpc::XmlRpcValue value;
  value["mpc"]["starts"][0] = 3;
  value["mpc"]["starts"][1] = 4;
  value["mpc"]["epsilon"] = 0.25;
  const YAML::Node tree = toYaml(value, "p");
  EXPECT_EQ(YAML::Dump(tree["mpc"]["starts"]), "[3, 4]");
  EXPECT_EQ(tree["mpc"]["epsilon"].Scalar(), "0.25");
}

TEST(XmlRpcToYaml, RefusesDatesBinaryDataAndNothingByName) {
  std::time_t now = 0;
  XmlRpc::XmlRpcValue date(std::gmtime(&now));
  char bytes[] = "ab";
  XmlRpc::XmlRpcValue binary(bytes, 2);
  for (const auto& bad : {date, binary, XmlRpc::XmlRpcValue()}) {
    XmlRpc::XmlRpcValue tree;
    tree["mpc"]["starts"][0] = bad;
    try {
      toYaml(tree, "/node");
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find("/node/mpc/starts[0]"), std::string::npos) << e.what();
    }
  }
}

TEST(NodeParams, ReadsTheParametersOfANodeFromTheServer) {
  const ros::NodeHandle pnh("~");
  ParamReader reader(nodeParams(pnh), pnh.getNamespace());
  const auto options = reader.read<MpcOptions>("mpc");
  EXPECT_EQ(options.horizon, 25);
  EXPECT_EQ(options.epsilon, 1e-4);
  EXPECT_EQ(options.max_torque, 0.1 + 0.2);
  EXPECT_FALSE(options.warm_start);
  EXPECT_EQ(options.goal_image, "007");
  EXPECT_EQ(options.starts, std::vector<int>({3, 4}));
  EXPECT_EQ(options.start_scale, std::vector<double>({1.0, 0.5}));
  ASSERT_EQ(reader.problems().size(), 1u);  // image_transport is unknown until ignore()
  reader.ignore("image_transport");
  EXPECT_NO_THROW(reader.requireValid());
}

TEST(NodeParams, LaysPrivateParametersOverTheConfigurationOfTheNamespace) {
  ParamReader reader(nodeParams(ros::NodeHandle("/shared/node")));
  const auto options = reader.read<MpcOptions>("mpc");
  EXPECT_EQ(options.horizon, 6);
  EXPECT_EQ(options.epsilon, 1e-3);
  reader.ignore("trial");  // a block of another package
  EXPECT_NO_THROW(reader.requireValid());
  EXPECT_EQ(nodeParams(ros::NodeHandle("/shared/other"))["mpc"]["horizon"].Scalar(), "5");
}

TEST(NodeParams, RefusesAConfigurationThatIsNotAText) {
  EXPECT_THROW(nodeParams(ros::NodeHandle("/broken/node")), std::invalid_argument);
}

TEST(NodeParams, RefusesAValueInPlaceOfParameters) {
  const ros::NodeHandle pnh("~image_transport");
  EXPECT_THROW(nodeParams(pnh), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
