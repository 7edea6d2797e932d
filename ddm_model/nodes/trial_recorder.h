// trial_recorder: one bag per trial, complete or not under its final name.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_writer.h>
#include <ddm_common/option_checks.h>
#include <ddm_msgs/StartRecording.h>
#include <ddm_msgs/StopRecording.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace ddm {

/// Block `recorder`.
struct RecorderOptions {
  double timeout = 5.0;  ///< wall time that the last messages of a trial may take to arrive [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("timeout", timeout);
  }
  std::vector<std::string> problems() const {
    OptionChecks recorder("recorder");
    recorder.requireTimeLimit("timeout", timeout);
    return recorder.problems();
  }
};

/// Services `start_recording` and `stop_recording`; writes images, the goal image, and the torques
/// that acted, by topic `applied_torque`. An image whose torque did not act in time has none in the
/// bag: the trial has a gap there. An image of which nobody says what acted is an error.
/// Needs a spinner with two threads or more: stopping waits for messages on their way.
class TrialRecorder {
 public:
  TrialRecorder(ros::NodeHandle nh, const BagOptions& bag, const RecorderOptions& options);

 private:
  bool start(ddm_msgs::StartRecording::Request& request,
             ddm_msgs::StartRecording::Response& response);
  bool stop(ddm_msgs::StopRecording::Request& request, ddm_msgs::StopRecording::Response& response);
  void writeGoal(BagWriter* bag) const;
  template <class Message>
  void record(const Message& message);
  void recordApplied(const ddm_msgs::Torque& torque);
  bool hasGoal(const ddm_msgs::StopRecording::Request& request) const;
  bool complete(const ddm_msgs::StopRecording::Request& request) const;
  std::string shortcoming(const ddm_msgs::StopRecording::Request& request) const;

  BagOptions bag_options_;
  RecorderOptions options_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::unique_ptr<BagWriter> bag_;  // null while not recording
  ros::Time after_;                 // messages up to this stamp are of an earlier trial
  std::string error_;               // first write that failed
  std::set<ros::Time> unanswered_;  // images of which is known that no torque acted in time
  sensor_msgs::ImageConstPtr goal_;
  int num_recordings_ = 0;
  int stopping_ = 0;  // the recording for whose end a stop waits or has waited
  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_sub_;
  ros::Subscriber torque_sub_;
  ros::Subscriber goal_sub_;
  ros::ServiceServer start_server_;
  ros::ServiceServer stop_server_;
};

}  // namespace ddm
