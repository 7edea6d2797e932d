// The first time on /clock, which comes late or never.
// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_time.h"

#include <ddm_node/topic_peers.h>
#include <ros/ros.h>

#include <sstream>
#include <stdexcept>

namespace ddm {

void waitForSimulatedTime(double limit) {
  if (ros::Time::waitForValid(ros::WallDuration(limit)) || !ros::ok()) return;
  std::ostringstream text;
  text << "simulated time does not come (waited " << limit << " s), "
       << describePublishers("/clock");
  throw std::runtime_error(text.str());
}

}  // namespace ddm
