// Lock-step: simulated time stops until the torque for the image arrives.
// SPDX-License-Identifier: BSD-3-Clause
#include <rosgraph_msgs/Clock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "ddm_common/option_checks.h"
#include "ddm_common/param_value.h"
#include "ddm_common/topic_peers.h"
#include "sim_node.h"

namespace ddm {
namespace {

/// Publishes image t, waits for the torque that carries the stamp of this image, takes a step, and
/// publishes image t + 1.
///
///   idle --reset--> image 0 --torque--> image 1 --torque--> ... image num_steps - 1 --torque-->
///   idle
///
/// An image that the camera loses is never published: the plant moves for another dt under the last
/// torque, and the stamps have a gap. A torque with another stamp is counted and ignored. If a
/// torque is invalid or does not arrive within the watchdog's wall time, the episode ends, and the
/// node is idle until the next reset. /clock never runs backwards: each episode starts later than
/// the end of the previous one, with a gap that is longer than a step. Ground truth and /clock are
/// published ten milliseconds of wall time after the image, together for all images since the last
/// publication. Stamps are whole nanoseconds, so stamps can be compared for equality.
class LockstepSim : public SimNode {
 public:
  LockstepSim(ros::NodeHandle nh, std::unique_ptr<Environment> environment,
              const SimOptions& options, const ShowOptions& show)
      : SimNode(nh, std::move(environment)),
        clock_pub_(nh.advertise<rosgraph_msgs::Clock>("/clock", 1, /*latch=*/true)),
        options_(options),
        step_ns_(static_cast<std::uint64_t>(std::llround(this->plant().info().dt * kSecond))),
        now_ns_(kSecond) {  // not 0, which ROS treats as "no time yet"
    if (show.frame_rate > 0.0) pace_.emplace(show.frame_rate);
    tell_timer_ = nh.createWallTimer(
        ros::WallDuration(kTellPeriod), [this](const ros::WallTimerEvent&) { tell(); },
        /*oneshot=*/true, /*autostart=*/false);
    tell();
    publishGoal(now());
    // Ticks are used instead of one long timer, because ticks stop while this process itself is
    // suspended. A torque that waits in the queue during this time is therefore not reported as
    // missing.
    watchdog_ = nh.createWallTimer(ros::WallDuration(options_.watchdog / kWatchdogTicks),
                                   &LockstepSim::onWatchdogTick, this);
  }

 private:
  static constexpr std::uint64_t kSecond = 1000000000;  // [ns]
  static constexpr int kWatchdogTicks = 20;
  static constexpr double kTellPeriod = 0.01;  // of wall time [s]

  ros::Time beginTrial(const ddm_msgs::Reset::Request& request) override {
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
    showImage();
    return now();
  }

  void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                  const std::string& publisher) override {
    const ros::Time& stamp = message.header.stamp;
    if (!running_ || stamp != now()) {
      if (++ignored_ == 1) {
        ROS_WARN_STREAM("torque of " << publisher << " with stamp " << stamp
                                     << " ignored, waiting for "
                                     << (running_ ? frameName() : "a reset")
                                     << "; further ones of this trial are only counted");
      }
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
    } while (!showImage());
    publishApplied(message);  // after the image, because the controller waits for the image
    ++frame_;
  }

  void torqueRefused(const ros::Time& stamp, const std::string& reason) override {
    if (!running_ || stamp != now()) {
      if (++ignored_ == 1) ROS_WARN_STREAM(reason);
      return;
    }
    ROS_ERROR_STREAM(trial_ << " ends at " << frameName()
                            << ", a reset starts another: " << reason);
    endTrial();
  }

  /// @return false if the camera has lost the image
  bool showImage() {
    if (pace_) pace_->sleep();  // last, when all work of this step is done
    silent_ticks_ = 0;
    tell_timer_.start();  // has no effect if the timer is running
    return publishImage(now());
  }

  /// Publishes ground truth and time. The control loop does not need these messages, but each
  /// message wakes up several nodes, so the messages of all images of a kTellPeriod are sent
  /// together.
  void tell() {
    tell_timer_.stop();
    publishGroundTruth();
    rosgraph_msgs::Clock clock;
    clock.clock = now();
    clock_pub_.publish(clock);
  }

  void onWatchdogTick(const ros::WallTimerEvent& /*event*/) {
    // The first tick after an image may come immediately, so this tick is not counted.
    if (!running_ || ++silent_ticks_ <= kWatchdogTicks) return;
    ROS_ERROR_STREAM("no torque for "
                     << frameName() << " within " << formatDouble(options_.watchdog)
                     << " s: " << describePublishers(torques().getTopic()) << " (" << ignored_
                     << " torques with another stamp ignored). " << trial_
                     << " ends, a reset starts another");
    endTrial();
  }

  void endTrial() {
    running_ = false;
    tell();
  }

  std::string frameName() const { return textOf("frame ", frame_, " (stamp ", now(), ")"); }

  ros::Time now() const { return ros::Time().fromNSec(now_ns_); }

  ros::Publisher clock_pub_;
  SimOptions options_;
  std::optional<ros::WallRate> pace_;  ///< empty: no limit of the frame rate
  std::uint64_t step_ns_;              ///< dt [ns]
  std::uint64_t now_ns_;               ///< simulated time, and stamp of the current image [ns]
  bool running_ = false;               ///< true while the current image waits for its torque
  bool first_trial_ = true;            ///< true before the first image
  std::string trial_;                  ///< "trial 3" or "evaluation 3"
  std::uint32_t num_steps_ = 0;
  /// Index of the current image among the published images of the episode.
  std::uint64_t frame_ = 0;
  std::uint64_t ignored_ = 0;  ///< number of torques with another stamp in this episode
  int silent_ticks_ = 0;       ///< number of watchdog ticks since the image
  ros::WallTimer watchdog_;
  ros::WallTimer tell_timer_;
};

}  // namespace

std::unique_ptr<SimNode> makeLockstepSim(const ros::NodeHandle& nh,
                                         std::unique_ptr<Environment> environment,
                                         const SimOptions& options, const ShowOptions& show) {
  return std::make_unique<LockstepSim>(nh, std::move(environment), options, show);
}

}  // namespace ddm
