// robot_node: the services that enable the motors, take the goal image and reset the robot.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/topic_peers.h>
#include <ddm_common/waiting.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include "robot_node.h"

namespace ddm {
namespace {

constexpr double kStepTolerance = 0.1;  // relative to dt; a larger error gives a warning
// Relative to dt; with a larger error, each step would count as a gap.
constexpr double kMaxStepTolerance = 0.5;
constexpr char kGoalInTrial[] = "a trial is under way, and it has a goal: wait for its end";
const ros::WallDuration kPollPeriod(0.05);
const ros::WallDuration kRemindPeriod(10.0);

double timeLeft(const ros::SteadyTime& deadline) {
  return (deadline - ros::SteadyTime::now()).toSec();
}
bool timeIsLeft(const ros::SteadyTime& deadline) { return ros::ok() && timeLeft(deadline) > 0.0; }

/// Removes the digits of a problem, because a problem that only changes its numbers is not logged
/// again.
std::string withoutNumbers(std::string text) {
  text.erase(std::remove_if(text.begin(), text.end(),
                            [](unsigned char c) { return std::isdigit(c) != 0; }),
             text.end());
  return text;
}

}  // namespace

bool RobotNode::onEnable(std_srvs::SetBool::Request& request,
                         std_srvs::SetBool::Response& response) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string problem;
  if (request.data) {
    lookAtPeers();
    problem = routine_runs_ && !routine_moves_
                  ? "the reset service still runs, although the motors were switched off: wait for "
                    "its end"
                  : gate_.arm(steadyNow());
    publishEffort();
  } else {
    stop("service enable stopped them");
  }
  response.success = problem.empty();
  response.message = problem.empty() ? gate_.describe() : problem;
  return true;
}

void RobotNode::loadGoal() {
  if (options_.goal_file.empty()) return;
  if (!std::filesystem::exists(options_.goal_file)) {
    log_.warn("there is no goal image " + options_.goal_file +
              " yet: call service take_goal to write it");
    return;
  }
  const sensor_msgs::Image image = readImageFile(options_.goal_file);
  if (std::min(image.width, image.height) < static_cast<std::uint32_t>(image_size_)) {
    throw std::invalid_argument(
        "the goal image " + options_.goal_file + " has " + std::to_string(image.width) + "x" +
        std::to_string(image.height) + " pixels, and must have at least image/size " +
        std::to_string(image_size_) +
        " in each direction: remove the file, and write it by service take_goal");
  }
  publishGoal(encodeImage(decodeImage(image, image_size_), image_size_, ros::Time::now(), ""));
}

/// @throws std::runtime_error during an episode
void RobotNode::publishGoal(const sensor_msgs::Image& goal) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (gate_.inTrial()) throw std::runtime_error(kGoalInTrial);
  goal_pub_.publish(goal);
  has_goal_ = true;
}

bool RobotNode::onTakeGoal(std_srvs::Trigger::Request& /*request*/,
                           std_srvs::Trigger::Response& response) {
  sensor_msgs::ImageConstPtr image;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (gate_.inTrial()) {
      response.message = kGoalInTrial;
      return true;
    }
    if (!seesCamera()) {
      response.message = "no image on " + camera_sub_.getTopic();
      return true;
    }
    response.message = formatProblem(*image_);
    if (!response.message.empty()) return true;
    image = image_;
  }
  try {  // without the lock, because a slow disk must not delay a stop
    const sensor_msgs::Image goal = shown(*image);
    if (!options_.goal_file.empty()) writeImageFile(options_.goal_file, goal);
    publishGoal(goal);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      camera_format_ = formatOf(*image);
    }
    response.success = true;
    response.message = "the goal is what the camera sees now" +
                       (options_.goal_file.empty() ? "" : ", and in " + options_.goal_file);
  } catch (const std::exception& e) {
    response.message = e.what();
  }
  return true;
}

bool RobotNode::onReset(ddm_msgs::Reset::Request& /*request*/,
                        ddm_msgs::Reset::Response& response) {
  const std::unique_lock<std::mutex> only(one_reset_, std::try_to_lock);
  if (!only) {
    response.message = "another reset is under way: wait for its end";
    return true;
  }
  if (!options_.holdsForAStep()) {
    response.message = textOf(
        "robot/max_hold is ", options_.max_hold, " s and robot/dt is ", options_.dt,
        " s, so that no torque would act for a whole step: set robot/max_hold to at least dt");
    return true;
  }
  const ros::SteadyTime deadline =
      ros::SteadyTime::now() + ros::WallDuration(options_.reset_timeout);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    gate_.beginReset();
    publishEffort();
  }
  // The goal image comes first, because the robot must leave its initial state to show the goal. A
  // person reaches into the workspace to move the robot to its initial state, so the motors are
  // switched on after that. A reset service needs the motors before.
  const bool uses_motors = !reset_service_.empty();
  std::string problem = waitFor(uses_motors ? Motors::kOn : Motors::kAny, deadline);
  if (problem.empty()) problem = moveToInitialState(deadline);
  if (problem.empty()) problem = waitFor(Motors::kFit, deadline);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    gate_.endReset();
    if (problem.empty()) problem = stepProblem();
    restartImages();
    publishEffort();
  }
  response.success = problem.empty();
  response.message = problem;
  response.start = ros::Time::now();
  if (!problem.empty()) log_.error("reset: " + problem);
  return true;
}

/// Forgets the stamps of all previous images; the estimate of the camera's rate is kept.
void RobotNode::restartImages() {
  stamps_.restart();
  picker_.restart();
}

/// Describes why no episode can begin at the frame rate of the camera; empty if it can, perhaps
/// after a warning.
std::string RobotNode::stepProblem() {
  const double step = picker_.step();  // 0 if the step is not known yet
  const double error = std::abs(step - options_.dt);
  if (step == 0.0 || error <= kStepTolerance * options_.dt) return "";
  const std::string problem =
      textOf("the camera's rate does not fit: images are ", step, " s apart where robot/dt is ",
             options_.dt, " s: make dt a whole multiple of the time between images");
  if (error > kMaxStepTolerance * options_.dt) return "the trial cannot begin: " + problem;
  log_.warn(problem);
  return "";
}

std::string RobotNode::moveToInitialState(const ros::SteadyTime& deadline) {
  try {
    return reset_service_.empty() ? askPerson(deadline) : callResetService(deadline);
  } catch (const std::exception& e) {
    return std::string("the robot was not brought to its initial state: ") + e.what();
  }
}

std::string RobotNode::askPerson(const ros::SteadyTime& deadline) {
  const std::string call = "rosservice call " + reset_done_server_.getService();
  person_asked_ = true;
  log_.warn("Bring the robot to its initial state. Then: " + call);
  while (timeIsLeft(deadline) && person_asked_) kPollPeriod.sleep();
  if (!person_asked_.exchange(false)) return "";
  return "nobody said in time that the robot is in its initial state: " + call +
         ", or set a longer robot/reset_timeout";
}

bool RobotNode::onResetDone(std_srvs::Trigger::Request& /*request*/,
                            std_srvs::Trigger::Response& response) {
  response.success = person_asked_.exchange(false);
  response.message = response.success ? "the trial may begin"
                                      : "no reset waits for the robot: begin a trial first";
  return true;
}

/// Calls the user's service, which moves the robot and needs the motors; a stop takes the motors
/// away from the service. Services are called in threads of their own, because a stopped master may
/// never answer.
std::string RobotNode::callResetService(const ros::SteadyTime& deadline) {
  const std::string service = "service " + reset_service_;
  const auto exists = [name = reset_service_] {
    return ros::service::exists(name, /*print_failure=*/false);
  };
  while (!answerWithin(timeLeft(deadline), exists).value_or(false)) {
    if (!timeIsLeft(deadline)) {
      return service + " is not offered: start its node, or correct robot/reset_service";
    }
    kPollPeriod.sleep();
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!gate_.armed()) {
      return "the robot was not brought to its initial state: " + gate_.describe();
    }
    routine_runs_ = routine_moves_ = true;
  }
  const auto trigger = std::make_shared<std_srvs::Trigger>();
  const std::optional<bool> answer =
      answerWithin(timeLeft(deadline),
                   [trigger, name = reset_service_] { return ros::service::call(name, *trigger); });
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool stopped = !routine_moves_;
    routine_runs_ = routine_moves_ = false;
    if (!answer) {
      stop("the reset service does not answer");
      return service +
             " does not answer, and the motors were switched off: look at its node, or set a "
             "longer robot/reset_timeout";
    }
    if (stopped) {
      return "the motors were switched off while the reset service moved the robot: call service "
             "enable, and begin the trial again";
    }
  }
  if (*answer && trigger->response.success) return "";
  if (*answer && !trigger->response.message.empty()) {
    return service + ": " + trigger->response.message;
  }
  return service + (*answer ? " failed without a message" : " ended without an answer") +
         ": look at the output of its node";
}

/// Waits until all requirements of an episode are met.
/// @return the requirement that was not met in time; empty if all are met
std::string RobotNode::waitFor(Motors motors, const ros::SteadyTime& deadline) {
  std::string told;
  ros::SteadyTime last_told;
  for (;;) {
    const std::string what = missing(motors);
    if (what.empty()) return "";
    if (!timeIsLeft(deadline)) return "the trial cannot begin: " + what;
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (withoutNumbers(what) != told || now - last_told > kRemindPeriod) {
      told = withoutNumbers(what);
      last_told = now;
      log_.warn("the trial waits: " + what);
    }
    kPollPeriod.sleep();
  }
}

/// Returns the first unmet requirement of an episode; empty if all are met.
std::string RobotNode::missing(Motors motors) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!seesCamera()) {
    lock.unlock();  // because a slow answer of the master must not delay a stop
    return "no image from the camera, " +
           describeImagePublishers(camera_sub_.getTopic(), "camera:=");
  }
  std::string problem = stamps_.compare(image_arrival_clock_, toStamp(image_->header.stamp));
  if (problem.empty()) problem = image_problem_;
  if (!problem.empty()) {
    restartImages();  // because the clocks may be corrected while the node waits
    return problem;
  }
  if (!has_goal_) return "no goal image: bring the robot to its goal and call service take_goal";
  if (motors == Motors::kAny) return "";
  if (!gate_.armed()) return gate_.describe();
  // A joint may be beyond its limits before the reset service moves the robot.
  return motors == Motors::kFit ? gate_.fault(steadyNow()) : "";
}

}  // namespace ddm
