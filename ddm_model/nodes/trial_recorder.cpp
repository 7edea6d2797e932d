// trial_recorder: one bag per trial, complete or not under its final name.
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_recorder.h"

#include <ddm_msgs/topics.h>

#include <chrono>
#include <cmath>

namespace ddm {
namespace {

constexpr int kQueue = 1000;  // a slow disk must not cost a frame

}  // namespace

std::vector<std::string> RecorderOptions::problems() const {
  if (timeout > 0.0 && std::isfinite(timeout)) return {};
  return {"recorder/timeout must be > 0, got " + std::to_string(timeout)};
}

TrialRecorder::TrialRecorder(ros::NodeHandle nh, const BagOptions& bag, const BagAccess& access,
                             const RecorderOptions& options)
    : bag_options_(bag), access_(access), options_(options), transport_(nh) {
  goal_sub_ = nh.subscribe<sensor_msgs::Image>(topics::kGoalImage, 1,
                                               [this](const sensor_msgs::ImageConstPtr& goal) {
                                                 const std::lock_guard<std::mutex> lock(mutex_);
                                                 goal_ = goal;
                                               });
  image_sub_ = transport_.subscribe(
      topics::kImage, kQueue, [this](const sensor_msgs::ImageConstPtr& image) { record(*image); });
  torque_sub_ = nh.subscribe<ddm_msgs::Torque>(
      topics::kTorque, kQueue, [this](const ddm_msgs::TorqueConstPtr& torque) { record(*torque); },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  start_server_ = nh.advertiseService(topics::kStartRecording, &TrialRecorder::start, this);
  stop_server_ = nh.advertiseService(topics::kStopRecording, &TrialRecorder::stop, this);
}

template <class Message>
void TrialRecorder::record(const Message& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (bag_ == nullptr || !error_.empty()) return;
  if (!after_.isZero() && message.header.stamp <= after_) return;
  try {
    writeGoal(message.header.stamp);
    bag_->write(message);
  } catch (const std::exception& e) {
    error_ = e.what();
    ROS_ERROR_STREAM("recording stopped: " << error_);
  }
  frame_written_.notify_all();
}

/// The goal image is stamped with the trial's first message, so that the bag begins with the trial.
void TrialRecorder::writeGoal(const ros::Time& stamp) {
  if (goal_written_ || goal_ == nullptr) return;
  bag_->writeGoal(*goal_, stamp);
  goal_written_ = true;
}

bool TrialRecorder::start(ddm_msgs::StartRecording::Request& request,
                          ddm_msgs::StartRecording::Response& response) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (bag_ != nullptr) ROS_WARN("a recording was not stopped: its bag stays *.active");
  bag_.reset();
  ++num_recordings_;
  frame_written_.notify_all();  // a stop that still waits for the old one
  error_.clear();
  after_ = request.after;
  goal_written_ = false;
  try {
    access_.requireNew(request.path);
    bag_ = std::make_unique<BagWriter>(request.path, bag_options_);
    response.success = true;
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(response.message);
  }
  return true;
}

bool TrialRecorder::stop(ddm_msgs::StopRecording::Request& request,
                         ddm_msgs::StopRecording::Response& response) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (bag_ == nullptr) {
    response.message = "nothing is being recorded";
    return true;
  }
  const std::int64_t due = request.num_steps;
  // Other services run while this one waits: afterwards the recording may be another one.
  const int recording = num_recordings_;
  const auto replaced = [&] { return bag_ == nullptr || num_recordings_ != recording; };
  const auto complete = [&] {
    return bag_->numFrames() >= due && (due > 0 || bag_->numFrames() == bag_->numImages());
  };
  frame_written_.wait_for(lock, std::chrono::duration<double>(options_.timeout),
                          [&] { return replaced() || !error_.empty() || complete(); });
  if (replaced()) {
    response.message = "another recording was started or stopped meanwhile";
    return true;
  }
  const std::unique_ptr<BagWriter> bag = std::move(bag_);
  response.images = bag->numImages();
  response.torques = bag->numTorques();
  if (error_.empty() && bag->numFrames() < due) {
    error_ = "of " + std::to_string(due) + " images and torques that are due, the bag holds " +
             std::to_string(bag->numImages()) + " and " + std::to_string(bag->numTorques()) +
             ", and " + std::to_string(bag->numFrames()) + " pairs of them";
  }
  try {
    if (error_.empty()) bag->close();
  } catch (const std::exception& e) {
    error_ = e.what();
  }
  response.success = error_.empty();
  response.message = error_;
  if (!response.success) ROS_ERROR_STREAM("recording: " << response.message);
  return true;
}

}  // namespace ddm
