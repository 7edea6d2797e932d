// Lock-step: simulated time stands still until each image has its torque.
// SPDX-License-Identifier: BSD-3-Clause
#include "lockstep_sim.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "ddm_node/topic_peers.h"
#include "ddm_params/param_value.h"

namespace ddm {
namespace {

constexpr std::uint64_t kSecond = 1000000000;  // [ns]
constexpr int kWatchdogTicks = 20;
const ros::WallDuration kTellPeriod(0.001);

}  // namespace

LockstepSim::LockstepSim(ros::NodeHandle nh, std::unique_ptr<Rig> rig, const SimOptions& options,
                         const ShowOptions& show)
    : SimNode(nh, std::move(rig), /*clock=*/true),
      options_(options),
      step_ns_(static_cast<std::uint64_t>(std::llround(this->plant().info().dt * kSecond))),
      now_ns_(kSecond) {  // not 0, which means "no time yet" to everybody else
  if (show.frame_rate > 0.0) pace_.emplace(show.frame_rate);
  tell_timer_ = nh.createWallTimer(
      kTellPeriod, [this](const ros::WallTimerEvent&) { tell(); }, /*oneshot=*/true,
      /*autostart=*/false);
  tell();
  publishGoal(now());
  // Ticks instead of one long timer: they stop counting while this process itself is held up, so a
  // torque that waits in the queue meanwhile is not called missing.
  watchdog_ = nh.createWallTimer(ros::WallDuration(options_.watchdog / kWatchdogTicks),
                                 &LockstepSim::onWatchdogTick, this);
}

ros::Time LockstepSim::beginTrial(const ddm_msgs::Reset::Request& request) {
  if (running_) ROS_WARN_STREAM(trial_ << " is cut short by a reset at " << frameName());
  if (!first_trial_) now_ns_ += std::max(kSecond, 2 * step_ns_);
  first_trial_ = false;
  trial_ = (request.evaluation ? "evaluation " : "trial ") + std::to_string(request.trial);
  num_steps_ = request.num_steps;
  frame_ = 0;
  ignored_ = 0;
  running_ = true;
  tell();
  publishGoal(now());
  showFrame();
  return now();
}

void LockstepSim::takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                             const std::string& publisher) {
  const ros::Time& stamp = message.header.stamp;
  if (!running_ || stamp != now()) {
    ++ignored_;
    ROS_WARN_STREAM_THROTTLE(
        5.0, "torque of " << publisher << " with stamp " << stamp << " ignored (" << ignored_
                          << " so far), waiting for " << (running_ ? frameName() : "a reset"));
    return;
  }
  if (num_steps_ != 0 && frame_ + 1 == num_steps_) {
    ROS_INFO_STREAM(trial_ << ": " << num_steps_ << " frames answered, " << ignored_
                           << " torques ignored");
    publishApplied(message);
    endTrial();
    return;
  }
  do {
    if (!advance(torque)) {
      endTrial();
      return;
    }
    now_ns_ += step_ns_;
  } while (!showFrame());
  publishApplied(message);  // after the image, for which the controller waits
  ++frame_;
}

void LockstepSim::torqueRefused(const ros::Time& stamp, const std::string& reason) {
  if (!running_ || stamp != now()) return;
  ROS_ERROR_STREAM(trial_ << " ends at " << frameName() << ", a reset starts another: " << reason);
  endTrial();
}

/// @return false if the camera has lost the frame
bool LockstepSim::showFrame() {
  if (pace_) pace_->sleep();  // nothing else is to be done: whoever has answered is waiting, too
  silent_ticks_ = 0;
  tell_timer_.start();  // does nothing if it runs
  return publishFrame(now());
}

/// Ground truth and time. No node waits for them, but several wake up for each message: soon is
/// soon enough, and cheaper for all frames of a kTellPeriod together.
void LockstepSim::tell() {
  tell_timer_.stop();
  publishGroundTruth();
  publishClock(now());
}

void LockstepSim::onWatchdogTick(const ros::WallTimerEvent& /*event*/) {
  // The first tick after a frame may come at once, so it does not count as time passed.
  if (!running_ || ++silent_ticks_ <= kWatchdogTicks) return;
  ROS_ERROR_STREAM("no torque for " << frameName() << " within " << formatDouble(options_.watchdog)
                                    << " s: " << describePublishers(torqueTopic()) << " ("
                                    << ignored_ << " torques with another stamp ignored). "
                                    << trial_ << " ends, a reset starts another");
  endTrial();
}

void LockstepSim::endTrial() {
  running_ = false;
  tell();
}

std::string LockstepSim::frameName() const {
  std::ostringstream name;
  name << "frame " << frame_ << " (stamp " << now() << ")";
  return name.str();
}

}  // namespace ddm
