// How a robot gets to the start of a trial: a service of the user does it, or a person.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/waiting.h>
#include <ddm_msgs/topics.h>
#include <poll.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace ddm {

/// Needs a spinner with another thread than the one that runs it.
class ResetRoutine {
 public:
  /// @param service  std_srvs/Trigger that brings the robot to its start; empty: a person does
  /// @param begin    called before the service takes over the motors: why it may not; empty: it may
  /// @param end      called after, with whether the service has answered: why its answer does not
  ///                 count; empty: it counts
  ResetRoutine(ros::NodeHandle nh, const std::string& service, std::function<std::string()> begin,
               std::function<std::string(bool)> end)
      : nh_(nh),
        service_(service.empty() ? "" : nh.resolveName(service)),
        begin_(std::move(begin)),
        end_(std::move(end)),
        done_server_(nh_.advertiseService(topics::kResetDone, &ResetRoutine::onDone, this)) {}

  /// Whether a service moves the robot, and not a person.
  bool usesMotors() const { return !service_.empty(); }

  /// Brings the robot to its start. Blocks until it is there, or until the deadline.
  /// @return what went wrong; empty: nothing
  std::string run(const ros::SteadyTime& deadline) {
    return service_.empty() ? askPerson(deadline) : callService(deadline);
  }

 private:
  static double timeLeft(const ros::SteadyTime& deadline) {
    return (deadline - ros::SteadyTime::now()).toSec();
  }
  static bool timeIsLeft(const ros::SteadyTime& deadline) {
    return ros::ok() && timeLeft(deadline) > 0.0;
  }

  /// Waits a moment for a line on the terminal.
  /// @return whether there is one
  bool enterWasPressed() const {
    pollfd terminal{STDIN_FILENO, POLLIN, 0};
    char line[256];
    if (::isatty(STDIN_FILENO) != 0 && ::poll(&terminal, 1, kPoll_ms) == 0) return false;
    if ((terminal.revents & POLLIN) != 0 && ::read(STDIN_FILENO, line, sizeof(line)) > 0) {
      return true;
    }
    poll_.sleep();  // no terminal, or one that has gone: it would not make us wait
    return false;
  }

  /// Calls ROS in threads of their own, because a stopped master may never answer.
  std::string callService(const ros::SteadyTime& deadline) {
    const auto exists = [name = service_] {
      return ros::service::exists(name, /*print_failure=*/false);
    };
    while (!answerWithin(timeLeft(deadline), exists).value_or(false)) {
      if (!timeIsLeft(deadline)) {
        return "service " + service_ +
               " is not offered: start its node, or correct robot/reset_service";
      }
      poll_.sleep();
    }
    const auto trigger = std::make_shared<std_srvs::Trigger>();
    const std::string refusal = begin_();
    if (!refusal.empty()) return refusal;
    const std::optional<bool> answer = answerWithin(timeLeft(deadline), [trigger, name = service_] {
      return ros::service::call(name, *trigger);
    });
    const std::string stopped = end_(answer.has_value());
    if (!answer) {
      return "service " + service_ +
             " does not answer, and the motors were switched off: look at its node, or set a "
             "longer "
             "robot/reset_timeout";
    }
    if (!stopped.empty()) return stopped;
    if (!*answer) {
      return "service " + service_ + " ended without an answer: look at the output of its node";
    }
    if (trigger->response.success) return "";
    if (trigger->response.message.empty()) {
      return "service " + service_ + " failed without a message: look at the output of its node";
    }
    return "service " + service_ + ": " + trigger->response.message;
  }

  std::string askPerson(const ros::SteadyTime& deadline) {
    done_ = false;
    asking_ = true;
    ::tcflush(STDIN_FILENO, TCIFLUSH);  // ignore lines typed before the question
    ROS_WARN_STREAM("Bring the robot to its start. Then press Enter here, or: rosservice call "
                    << done_server_.getService());
    while (timeIsLeft(deadline) && !done_) {
      if (enterWasPressed()) done_ = true;
    }
    asking_ = false;
    if (done_) return "";
    return "nobody said in time that the robot is at its start: press Enter at the terminal of "
           "robot_node or call " +
           done_server_.getService() + ", or set a longer robot/reset_timeout";
  }

  bool onDone(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
    const bool asked = asking_;
    response.success = asked;
    response.message =
        asked ? "the trial may begin" : "no reset waits for the robot: begin a trial first";
    if (asked) done_ = true;
    return true;
  }

  static constexpr int kPoll_ms = 50;
  const ros::WallDuration poll_{1e-3 * kPoll_ms};
  ros::NodeHandle nh_;
  std::string service_;
  std::function<std::string()> begin_;
  std::function<std::string(bool)> end_;
  std::atomic<bool> asking_{false};
  std::atomic<bool> done_{false};
  ros::ServiceServer done_server_;
};

}  // namespace ddm
