// How a robot gets to the start of a trial: a service of the user does it, or a person.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <string>

namespace ddm {

/// Needs a spinner with another thread than the one that runs it.
class ResetRoutine {
 public:
  /// @param service  std_srvs/Trigger that brings the robot to its start; empty: a person does
  ResetRoutine(ros::NodeHandle nh, const std::string& service);

  /// Brings the robot to its start. Blocks until it is there, or until the deadline.
  /// @return what went wrong; empty: nothing
  std::string run(const ros::SteadyTime& deadline);

  bool byService() const { return !service_.empty(); }

 private:
  std::string callService(const ros::SteadyTime& deadline);
  std::string askPerson(const ros::SteadyTime& deadline);
  bool onDone(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  ros::NodeHandle nh_;
  std::string service_;
  std::atomic<bool> asking_{false};
  std::atomic<bool> done_{false};
  ros::ServiceServer done_server_;
};

}  // namespace ddm
