// round_trips: times the loop, or one of two nodes that only send its messages. ~role: `lockstep`, `camera` or `controller`.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_files/plain_file.h>
#include <ddm_images/image_codec.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ddm_params/param_value.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation.h"
#include "ros_driver.h"

namespace {

constexpr int kImageSize = 51;
constexpr int kQueue = 1000;
constexpr double kTimeout = 30.0;  // [s]
const ros::TransportHints kNoDelay = ros::TransportHints().tcpNoDelay();

/// Means over a tenth of a second.
class IntervalLog {
 public:
  /// So many events by now. The first ones do not count: connections and caches are new.
  void tick(int num_events) {
    if (num_events < kWarmUp) return;
    const Event now{std::chrono::steady_clock::now(), num_events};
    if (!last_) last_ = now;
    const std::chrono::duration<double, std::micro> interval = now.time - last_->time;
    if (interval < kInterval) return;
    intervals_us_.push_back(interval.count() / (now.number - last_->number));
    last_ = now;
  }

  /// `{median_us: ...}`, which appears at once and whole.
  /// @throws std::runtime_error if there is nothing to tell, or the file cannot be written
  void write(const std::string& path) const {
    if (intervals_us_.empty()) throw std::runtime_error("no round trip was timed");
    ddm::writeFileAtomically(
        path, "{median_us: " + ddm::formatDouble(ddm::quantile(intervals_us_, 0.5)) + "}\n");
  }

 private:
  struct Event {
    std::chrono::steady_clock::time_point time;
    int number;
  };

  static constexpr int kWarmUp = 100;
  static constexpr std::chrono::milliseconds kInterval{90};  // feedback comes each 100 ms or so

  std::optional<Event> last_;
  std::vector<double> intervals_us_;
};

/// Has the real nodes run one random trial, and times it by its feedback: to hear of each frame
/// would be a load.
void timeLockstep(const ros::NodeHandle& nh, int num_events, IntervalLog* log) {
  ddm::RosDriver::Peers peers;
  peers.recorder = peers.trainer = false;
  ddm::RosDriver driver(nh, kTimeout, peers);
  ddm::TrialRequest request;
  request.num_steps = num_events;
  request.epsilon = 1.0;
  driver.runTrial(request, [&](double fraction) {
    log->tick(static_cast<int>(std::lround(fraction * num_events)));
  });
}

/// Publishes an image as soon as the last one has its torque, and times that.
void timeBareCamera(ros::NodeHandle* nh, int num_events, IntervalLog* log) {
  const std::vector<std::uint8_t> grey(kImageSize * kImageSize, 100);
  const ros::Publisher images = nh->advertise<sensor_msgs::Image>(ddm::topics::kImage, kQueue);
  ros::Time stamp(1, 0);
  int num_answered = 0;
  const auto show = [&] {
    stamp += ros::Duration(0.2);
    images.publish(ddm::encodeImage(grey, kImageSize, stamp, "camera"));
  };
  const auto on_torque = [&](const ddm_msgs::TorqueConstPtr& torque) {
    if (torque->header.stamp != stamp) return;
    log->tick(++num_answered);
    if (num_answered < num_events) return show();
    ros::shutdown();
  };
  const ros::Subscriber torques = nh->subscribe<ddm_msgs::Torque>(
      ddm::topics::kTorque, kQueue, on_torque, ros::VoidConstPtr(), kNoDelay);
  const ros::WallTimer start = nh->createWallTimer(ros::WallDuration(0.05), [&](const auto&) {
    if (stamp == ros::Time(1, 0) && images.getNumSubscribers() && torques.getNumPublishers())
      show();
  });
  ros::spin();
}

void answer(ros::NodeHandle* nh) {
  const ros::Publisher torques = nh->advertise<ddm_msgs::Torque>(ddm::topics::kTorque, kQueue);
  const auto on_image = [&torques](const sensor_msgs::ImageConstPtr& image) {
    ddm_msgs::Torque torque;
    torque.header.stamp = image->header.stamp;
    torque.torque = {1.0};
    torques.publish(torque);
  };
  const ros::Subscriber images = nh->subscribe<sensor_msgs::Image>(
      ddm::topics::kImage, kQueue, on_image, ros::VoidConstPtr(), kNoDelay);
  ros::spin();
}

void run() {
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  const std::string role = private_nh.param<std::string>("role", "lockstep");
  if (role == "controller") return answer(&nh);
  const int num_events = private_nh.param("num_frames", 3000);
  IntervalLog log;
  if (role == "camera") {
    timeBareCamera(&nh, num_events, &log);
  } else {
    timeLockstep(nh, num_events, &log);
  }
  log.write(private_nh.param<std::string>("out", ""));
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "round_trips");
  try {
    run();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("round_trips: " << error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
