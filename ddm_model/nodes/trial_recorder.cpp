// trial_recorder: records one bag per trial. A bag under its final name is always complete.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_writer.h>
#include <ddm_bag_io/model_config.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/run_node.h>
#include <ddm_msgs/StartRecording.h>
#include <ddm_msgs/StopRecording.h>
#include <ddm_msgs/topics.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <iterator>
#include <memory>
#include <mutex>
#include <set>
#include <string>

namespace ddm {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr int kQueue = 1000;  // a slow disk must not lose an image
constexpr Seconds kSlice(0.1);
constexpr double kTimeout = 5.0;  // wall time in which a trial's last messages must arrive [s]

/// Refuses a path that is no *.bag or that exists.
void requireNew(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".bag") {
    throw std::runtime_error("bag '" + path + "': the path of a recording must end in .bag");
  }
  if (std::filesystem::exists(path)) {
    throw std::runtime_error("bag " + path +
                             " exists already: remove it, or record under another name");
  }
}

/// Services `start_recording` and `stop_recording`. Writes images, the goal image, and the torques
/// that acted (topic `applied_torque`). If no single torque acted in time after an image, an empty
/// torque reports it, and the trial has a gap there. An image without any report is an error. The
/// node needs a spinner with at least two threads, because stop() waits for messages on their way.
class TrialRecorder {
 public:
  TrialRecorder(ros::NodeHandle nh, const BagOptions& options) : options_(options), transport_(nh) {
    // Without TCP_NODELAY, TCP holds an image back until the one before is acknowledged.
    const auto no_delay = ros::TransportHints().tcpNoDelay();
    goal_sub_ = nh.subscribe<sensor_msgs::Image>(topics::kGoalImage, 1,
                                                 [this](const sensor_msgs::ImageConstPtr& goal) {
                                                   const std::lock_guard<std::mutex> lock(mutex_);
                                                   goal_ = goal;
                                                   changed_.notify_all();
                                                 });
    image_sub_ = transport_.subscribe(
        topics::kImage, kQueue, [this](const sensor_msgs::ImageConstPtr& image) { record(*image); },
        ros::VoidPtr(), image_transport::TransportHints("raw", no_delay));
    torque_sub_ = nh.subscribe<ddm_msgs::Torque>(
        topics::kAppliedTorque, kQueue,
        [this](const ddm_msgs::TorqueConstPtr& torque) { recordApplied(*torque); },
        ros::VoidConstPtr(), no_delay);
    start_server_ = nh.advertiseService(topics::kStartRecording, &TrialRecorder::start, this);
    stop_server_ = nh.advertiseService(topics::kStopRecording, &TrialRecorder::stop, this);
  }

 private:
  template <class Message>
  void record(const Message& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bag_ == nullptr || !error_.empty()) return;
    if (!after_.isZero() && message.header.stamp <= after_) return;
    try {
      bag_->write(message);
    } catch (const std::exception& e) {
      error_ = e.what();
      ROS_ERROR_STREAM("recording stopped: " << error_);
    }
    changed_.notify_all();
  }

  void recordApplied(const ddm_msgs::Torque& torque) {
    if (!torque.torque.empty()) return record(torque);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bag_ == nullptr) return;
    unanswered_.insert(torque.header.stamp);
    changed_.notify_all();
  }

  /// Writes the goal image with the stamp of the first image, so that the bag does not begin earlier.
  /// The first image may precede the trial: a robot publishes images during its reset, but training
  /// uses only those from the first torque to the last. The goal image is written at the end, because
  /// it may arrive after the first images.
  void writeGoal(BagWriter* bag) const {
    if (goal_ != nullptr && !bag->images().empty()) bag->writeGoal(*goal_, *bag->images().begin());
  }

  bool start(ddm_msgs::StartRecording::Request& request,
             ddm_msgs::StartRecording::Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bag_ != nullptr && request.path.empty()) {
      after_ = request.after;
      response.success = true;
      return true;
    }
    std::unique_ptr<BagWriter> bag;
    try {
      requireNew(request.path);
      bag = std::make_unique<BagWriter>(request.path, options_);
    } catch (const std::exception& e) {
      response.message = e.what() + std::string(bag_ == nullptr ? "" : "; the recording goes on");
      ROS_ERROR_STREAM(response.message);
      return true;
    }
    if (bag_ != nullptr) ROS_WARN("a recording was not stopped: its bag stays *.active");
    bag_ = std::move(bag);
    ++num_recordings_;
    changed_.notify_all();  // wakes a stop() that still waits for the old recording
    error_.clear();
    after_ = request.after;
    unanswered_.clear();
    response.success = true;
    return true;
  }

  bool hasGoal(const ddm_msgs::StopRecording::Request& request) const {
    return request.goal.isZero() || (goal_ != nullptr && goal_->header.stamp == request.goal);
  }

  /// @return whether the bag has all images of the trial and a report of the torque after each of
  ///         them
  bool complete(const ddm_msgs::StopRecording::Request& request) const {
    const std::set<ros::Time>& images = bag_->images();
    if (images.size() < request.num_steps) return false;
    if (!hasGoal(request)) return false;
    auto end = images.end();
    if (!request.last.isZero()) {
      end = images.upper_bound(request.last);
      if (images.count(request.last) == 0) return false;
    } else if (request.num_steps > 0) {
      end = std::next(images.begin(), request.num_steps);
    }
    return std::distance(images.begin(), end) >= request.num_steps &&
           std::all_of(images.begin(), end, [this](const ros::Time& stamp) {
             return bag_->torques().count(stamp) + unanswered_.count(stamp) > 0;
           });
  }

  /// @return why the bag does not contain the trial; empty if it does
  std::string shortcoming(const ddm_msgs::StopRecording::Request& request) const {
    if (request.num_steps == 0) return "";
    if (!hasGoal(request)) {
      return textOf("no goal image with stamp ", request.goal, " came on ", goal_sub_.getTopic(),
                    " within ", kTimeout, " s, the last one has stamp ",
                    goal_ == nullptr ? ros::Time() : goal_->header.stamp,
                    " (0: there is none): publish it with the stamp that reset answers");
    }
    if (!complete(request)) {
      return textOf("of ", request.num_steps, " images and torques that are due, the bag holds ",
                    bag_->images().size(), " and ", bag_->torques().size(), ", and ",
                    bag_->numFrames(), " pairs of them after ", kTimeout,
                    " s; whether a torque acted on the others was not reported: publish ",
                    torque_sub_.getTopic(), " for each image");
    }
    if (bag_->numFrames() > 0) return "";
    return textOf("no torque acted in time: there is nothing to learn from in ",
                  bag_->images().size(), " images");
  }

  bool stop(ddm_msgs::StopRecording::Request& request,
            ddm_msgs::StopRecording::Response& response) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (bag_ == nullptr) {
      response.message = "nothing is being recorded: call start_recording first";
      return true;
    }
    if (stopping_ == num_recordings_) {  // a second wait would block the last thread
      response.message = "this recording is being stopped already";
      return true;
    }
    // Other services run during the wait, so that another recording may replace this one.
    const int recording = stopping_ = num_recordings_;
    const auto replaced = [&] { return bag_ == nullptr || num_recordings_ != recording; };
    const auto decided = [&] { return replaced() || !error_.empty() || complete(request); };
    // Waits in slices: if the process is paused, at most one slice is lost, and messages that arrived
    // meanwhile are still read.
    for (double left = kTimeout; left > 0.0; left -= kSlice.count()) {
      if (changed_.wait_for(lock, std::min(kSlice, Seconds(left)), decided)) break;
    }
    if (replaced()) {
      response.message = "another recording was started or stopped meanwhile";
      return true;
    }
    if (error_.empty()) error_ = shortcoming(request);
    const std::unique_ptr<BagWriter> bag = std::move(bag_);
    response.images = static_cast<std::uint32_t>(bag->images().size());
    response.torques = static_cast<std::uint32_t>(bag->torques().size());
    response.pairs = static_cast<std::uint32_t>(bag->numFrames());
    try {
      if (error_.empty()) writeGoal(bag.get());
      if (error_.empty()) bag->close();
    } catch (const std::exception& e) {
      error_ = e.what();
    }
    response.success = error_.empty();
    response.message = error_;
    if (!response.success) ROS_ERROR_STREAM("recording: " << response.message);
    return true;
  }

  BagOptions options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<BagWriter> bag_;  // null: not recording
  ros::Time after_;                 // messages up to this stamp belong to an earlier trial
  std::string error_;               // error of the first write that failed
  std::set<ros::Time> unanswered_;  // images after which no torque acted in time
  sensor_msgs::ImageConstPtr goal_;
  int num_recordings_ = 0;
  int stopping_ = 0;  // number of the recording that stop() is waiting for or has waited for
  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_sub_;
  ros::Subscriber torque_sub_;
  ros::Subscriber goal_sub_;
  ros::ServiceServer start_server_;
  ros::ServiceServer stop_server_;
};

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  return ddm::runNode("trial_recorder", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
    params->ignore("image_transport");  // image_transport reads it
    const auto options = params->read<ddm::BagOptions>("data_set");
    params->requireValid();
    ddm::TrialRecorder recorder(nh, options);
    ros::MultiThreadedSpinner(2).spin();
  });
}
