// Tests of a node's parameters as YAML, with the parameter server.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/node_params.h"

#include <ddm_msgs/testing/expect_error.h>
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

TEST(XmlRpcToYaml, RefusesDatesBinaryDataAndNothingByName) {
  std::time_t now = 0;
  XmlRpc::XmlRpcValue date(std::gmtime(&now));
  char bytes[] = "ab";
  XmlRpc::XmlRpcValue binary(bytes, 2);
  for (const auto& bad : {date, binary, XmlRpc::XmlRpcValue()}) {
    XmlRpc::XmlRpcValue tree;
    tree["mpc"]["starts"][0] = bad;
    EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>([&] { toYaml(tree, "/node"); },
                                                             {"/node/mpc/starts[0]"}));
  }
}

TEST(NodeParams, ReadsTheParametersOfANodeFromTheServer) {
  const ros::NodeHandle pnh("~");
  const YAML::Node params = nodeParams(pnh), mpc = params["mpc"];
  EXPECT_EQ(mpc["horizon"].as<int>(), 25);
  EXPECT_EQ(mpc["epsilon"].as<double>(), 1e-4);
  EXPECT_EQ(mpc["max_torque"].as<double>(), 0.1 + 0.2);
  EXPECT_FALSE(mpc["warm_start"].as<bool>());
  EXPECT_EQ(mpc["goal_image"].as<std::string>(), "007");
  EXPECT_EQ(mpc["starts"].as<std::vector<int>>(), std::vector<int>({3, 4}));
  EXPECT_EQ(mpc["start_scale"].as<std::vector<double>>(), std::vector<double>({1.0, 0.5}));
  ParamReader reader(params, pnh.getNamespace());
  ASSERT_EQ(reader.problems().size(), 1u);  // image_transport is unknown until ignore()
  reader.ignore("image_transport");
  EXPECT_NO_THROW(reader.requireValid());
}

TEST(NodeParams, LaysPrivateParametersOverTheConfigurationOfTheNamespace) {
  const YAML::Node params = nodeParams(ros::NodeHandle("/shared/node"));
  EXPECT_EQ(params["mpc"]["horizon"].as<int>(), 6);
  EXPECT_EQ(params["mpc"]["epsilon"].as<double>(), 1e-3);
  EXPECT_EQ(params["trial"]["num_steps"].as<int>(), 7);
  EXPECT_EQ(nodeParams(ros::NodeHandle("/shared/other"))["mpc"]["horizon"].as<int>(), 5);
}

TEST(NodeParams, RefusesAConfigurationThatIsNotATextAndAValueInPlaceOfParameters) {
  EXPECT_THROW(nodeParams(ros::NodeHandle("/broken/node")), std::invalid_argument);
  EXPECT_THROW(nodeParams(ros::NodeHandle("~image_transport")), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
