// robot_node: what a person or the loop asks of it, to enable the motors, show a goal, or reset.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_codec.h>
#include <ddm_common/topic_peers.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "robot_node.h"

namespace ddm {
namespace {

constexpr double kStepTolerance = 0.1;     // of dt
constexpr double kMaxStepTolerance = 0.5;  // of dt: beyond, each step would count as a gap
constexpr char kGoalInTrial[] = "a trial is under way, and it has a goal: wait for its end";
const ros::WallDuration kWatchPeriod(0.1);
const ros::WallDuration kRemindPeriod(10.0);

/// A problem without its numbers: the same problem with another value need not be logged again.
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
    log_.warn("there is no picture " + options_.goal_file +
              " yet: call service take_goal to write it");
    return;
  }
  const sensor_msgs::Image picture = readPicture(options_.goal_file);
  if (std::min(picture.width, picture.height) < static_cast<std::uint32_t>(image_size_)) {
    throw std::invalid_argument(
        "the goal image " + options_.goal_file + " has " + std::to_string(picture.width) + "x" +
        std::to_string(picture.height) + " pixels, and must have at least image/size " +
        std::to_string(image_size_) +
        " in each direction: remove the file, and write it by service take_goal");
  }
  publishGoal(encodeImage(decodeImage(picture, image_size_), image_size_, ros::Time::now(), ""));
}

/// @throws std::runtime_error in a trial
void RobotNode::publishGoal(const sensor_msgs::Image& goal) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (gate_.inTrial()) throw std::runtime_error(kGoalInTrial);
  goal_pub_.publish(goal);
  has_goal_ = true;
}

bool RobotNode::onTakeGoal(std_srvs::Trigger::Request& /*request*/,
                           std_srvs::Trigger::Response& response) {
  sensor_msgs::ImageConstPtr frame;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (gate_.inTrial()) {
      response.message = kGoalInTrial;
      return true;
    }
    if (!seesCamera()) {
      response.message = "no image on " + frame_sub_.getTopic();
      return true;
    }
    response.message = formatProblem(*frame_);
    if (!response.message.empty()) return true;
    frame = frame_;
  }
  try {  // without the lock: a disk may be slow, and must not be in the way of a stop
    const sensor_msgs::Image goal = shown(*frame);
    if (!options_.goal_file.empty()) writePicture(options_.goal_file, goal);
    publishGoal(goal);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      camera_format_ = formatOf(*frame);
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
    std::ostringstream text;
    text << "robot/max_hold is " << options_.max_hold << " s and robot/dt is " << options_.dt
         << " s, so that no torque would act for a whole step: set robot/max_hold to at least dt";
    response.message = text.str();
    return true;
  }
  const ros::SteadyTime deadline =
      ros::SteadyTime::now() + ros::WallDuration(options_.reset_timeout);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    gate_.beginReset();
    publishEffort();
  }
  // The goal first: to show it, the robot has to leave its start. The motors last where a person
  // brings the robot to its start, who reaches in; first where a service of the user moves it.
  std::string problem =
      waitUntilThere(deadline, routine_.usesMotors() ? Motors::kOn : Motors::kAny);
  if (problem.empty()) problem = bringToStart(deadline);
  if (problem.empty()) problem = waitUntilThere(deadline, Motors::kFit);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    gate_.endReset();
    const double step = picker_.step();  // 0: not known
    if (step > 0.0 && std::abs(step - options_.dt) > kStepTolerance * options_.dt) {
      std::ostringstream text;
      text << "the camera's frames do not fit: images are " << step << " s apart where robot/dt is "
           << options_.dt << " s: make dt a whole multiple of the time between frames";
      if (std::abs(step - options_.dt) <= kMaxStepTolerance * options_.dt) {
        log_.warn(text.str());
      } else if (problem.empty()) {
        problem = "the trial cannot begin: " + text.str();
      }
    }
    stamps_.restart();
    picker_.restart();
    publishEffort();
  }
  response.success = problem.empty();
  response.message = problem;
  response.start = ros::Time::now();
  if (!problem.empty()) log_.error("reset: " + problem);
  return true;
}

/// Permission for the user's reset service to move the robot. A stop takes it back.
std::string RobotNode::beginRoutine() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!gate_.armed()) return "the robot was not brought to its start: " + gate_.describe();
  routine_runs_ = routine_moves_ = true;
  return "";
}

std::string RobotNode::endRoutine(bool answered) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool stopped = !routine_moves_;
  routine_runs_ = routine_moves_ = false;
  if (!answered) stop("the reset service does not answer");
  if (!stopped) return "";
  return "the motors were switched off while the reset service moved the robot: call service "
         "enable, and begin the trial again";
}

std::string RobotNode::bringToStart(const ros::SteadyTime& deadline) {
  try {
    return routine_.run(deadline);
  } catch (const std::exception& e) {
    return std::string("the robot was not brought to its start: ") + e.what();
  }
}

/// @return what has not come in time; empty: nothing
std::string RobotNode::waitUntilThere(const ros::SteadyTime& deadline, Motors motors) {
  std::string told;
  ros::SteadyTime last_told;
  for (;;) {
    const std::string what = missing(motors);
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (what.empty()) return "";
    if (!ros::ok() || now > deadline) return "the trial cannot begin: " + what;
    if (withoutNumbers(what) != told || now - last_told > kRemindPeriod) {
      told = withoutNumbers(what);
      last_told = now;
      log_.warn("the trial waits: " + what);
    }
    kWatchPeriod.sleep();
  }
}

/// What a trial cannot begin without, the first thing first; empty if nothing is missing.
std::string RobotNode::missing(Motors motors) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!seesCamera()) {
    lock.unlock();  // the master may be slow, and must not be in the way of a stop
    return "no image from the camera, " +
           describeImagePublishers(frame_sub_.getTopic(), "camera:=");
  }
  std::string problem = stamps_.compare(frame_arrival_clock_, toStamp(frame_->header.stamp));
  if (problem.empty()) problem = frame_problem_;
  if (!problem.empty()) {
    stamps_.restart();  // the clocks may be set while the trial waits
    picker_.restart();
    return problem;
  }
  if (!has_goal_) return "no goal image: bring the robot to its goal and call service take_goal";
  if (motors == Motors::kAny) return "";
  if (!gate_.armed()) return gate_.describe();
  // The reset service may bring a joint back that is beyond its limits.
  return motors == Motors::kFit ? gate_.fault(steadyNow()) : "";
}

}  // namespace ddm
