// Tests the answer of a simulator to a reset in which its plant fails.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <ros/callback_queue.h>

#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>

#include "ddm_plant_plugin/testing/toy_plant.h"
#include "sim_node.h"

namespace ddm {
namespace {

TEST(FailingPlant, IsTheAnswerToItsResetAndTheNextOneBegins) {
  bool fails = false;
  testing::ToyPlant::Traits traits;
  traits.draw = [&fails](const Eigen::VectorXd&) {
    if (fails) throw std::runtime_error("no display is free");
    return testing::plainImage(51, 255);
  };
  const auto sim = makeLockstepSim(
      ros::NodeHandle(),
      std::make_unique<Environment>(std::make_unique<testing::ToyPlant>(traits), CameraOptions()),
      SimOptions(), ShowOptions());
  const auto reset = [] {
    auto answer = std::async(std::launch::async, [] {
      ddm_msgs::Reset call;
      EXPECT_TRUE(ros::service::call(topics::kReset, call)) << "it did not answer";
      return call.response;
    });
    while (answer.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
    }
    return answer.get();
  };
  fails = true;
  const ddm_msgs::Reset::Response failed = reset();
  EXPECT_FALSE(failed.success);
  EXPECT_NE(failed.message.find("no display is free"), std::string::npos) << failed.message;
  fails = false;
  EXPECT_TRUE(reset().success);
}

}  // namespace
}  // namespace ddm
