// Time limits for ROS calls that could block without end: services and simulated time.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/waiting.h"

#include <chrono>
#include <sstream>
#include <utility>

#include "ddm_common/topic_peers.h"

namespace ddm {

std::string waited(double limit) {
  std::ostringstream text;
  text << " (waited " << limit << " s)";
  return text.str();
}

std::optional<bool> answerWithin(double limit, std::function<bool()> function) {
  return callWithin(std::chrono::duration<double>(limit), std::move(function), [] {
    if (!ros::ok()) throw std::runtime_error(kInterrupted);
  });
}

void waitForSimulatedTime(double limit) {
  if (ros::Time::waitForValid(ros::WallDuration(limit)) || !ros::ok()) return;
  throw std::runtime_error("simulated time does not come" + waited(limit) + ", " +
                           describePublishers("/clock"));
}

}  // namespace ddm
