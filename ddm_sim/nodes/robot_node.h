// robot_node: connects a real camera and real motors to the DDM nodes, in place of the simulator.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/log_thread.h>
#include <ddm_common/node_watch.h>
#include <ddm_msgs/Reset.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <ddm_robot/robot_options.h>
#include <ddm_robot/stamp_check.h>
#include <ddm_robot/torque_gate.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

namespace ddm {

inline Stamp toStamp(const ros::Time& time) {
  return Stamp(static_cast<std::int64_t>(time.toNSec()));
}

inline SteadyTime steadyNow() { return std::chrono::steady_clock::now(); }

/// Describes size and encoding of an image, for messages.
inline std::string formatOf(const sensor_msgs::Image& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height) + " " + image.encoding;
}

/// Publishes an image to the controller every dt, and passes its torques to the motors through a
/// TorqueGate. If the motors are off at the start of an episode, or are switched off during it, the
/// node cancels the episode: its torques do not act, so its samples are useless for learning.
///
/// Needs a spinner with several threads, because a reset may wait for a person while all other
/// callbacks continue.
/// Implementation: robot_node.cpp contains camera and motors; robot_reset.cpp contains the services
/// `enable`, `take_goal`, `reset` and `reset_done`.
class RobotNode {
 public:
  /// @param pnh  private node handle, with the user's choice of an image transport
  /// @throws std::invalid_argument if the topic of the camera is the topic that this node
  ///         publishes, or the goal image cannot be read
  RobotNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const RobotOptions& options);

  /// Switches the motors off immediately.
  void stopMotors(const std::string& reason);

 private:
  /// State of the motors that a reset requires before it continues. kAny: any state; kOn: on; kFit:
  /// on and without a fault.
  enum class Motors { kAny, kOn, kFit };

  template <class Work>
  void guarded(const Work& work);
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void onTorque(const ros::MessageEvent<const ddm_msgs::Torque>& event);
  void onJointStates(const ros::MessageEvent<const sensor_msgs::JointState>& event);
  void onTrialEnd(const ddm_msgs::RunTrialActionResultConstPtr& result);
  void onTick(const ros::SteadyTimerEvent& event);
  bool onEnable(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool onTakeGoal(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response);
  bool onResetDone(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  sensor_msgs::Image shown(const sensor_msgs::Image& image) const;
  void loadGoal();
  void publishGoal(const sensor_msgs::Image& goal);
  std::string waitFor(Motors motors, const ros::SteadyTime& deadline);
  std::string missing(Motors motors);
  std::string moveToInitialState(const ros::SteadyTime& deadline);
  std::string callResetService(const ros::SteadyTime& deadline);
  std::string askPerson(const ros::SteadyTime& deadline);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  // The caller must hold mutex_.
  void stop(const std::string& reason);
  bool seesCamera() const;
  std::string formatProblem(const sensor_msgs::Image& image) const;
  void refuseImage(const std::string& problem);
  void publishEffort();
  void sendEffort(const std::vector<double>& effort);
  void settle(bool acted);
  void reportState();
  void cancelTrial();
  void lookAtPeers();
  void restartImages();
  std::string stepProblem();

  LogThread log_;  // a stopped terminal must not delay a stop of the motors
  const int image_size_;
  const RobotOptions options_;
  const std::string reset_service_;  // resolved name; empty: a person resets the robot
  NodeWatch controller_watch_;

  std::mutex mutex_;  // guards the members that callbacks change, from gate_ to worst_latency_
  TorqueGate gate_;
  StampCheck stamps_;
  ImagePicker picker_;
  sensor_msgs::ImageConstPtr image_;  // newest image of the camera
  SteadyTime image_arrival_;
  Stamp image_arrival_clock_{0};  // image_arrival_ by the clock of this machine
  std::string image_problem_;     // why the newest image cannot be used
  // Size and encoding of the images that the crop was first used with; empty before.
  std::string camera_format_;
  bool has_goal_ = false;
  bool routine_runs_ = false;  // true while a call of the user's reset service is open
  // True while the reset service controls the motors and this node publishes no effort.
  bool routine_moves_ = false;
  // Torque that acts now and has not been reported yet; empty if all torques have been reported.
  ddm_msgs::Torque acting_;
  ros::SteadyTime last_image_log_;
  bool was_armed_ = false;
  std::string last_state_;
  std::string last_frozen_;
  int last_misses_ = -1;
  double worst_latency_ = 0.0;  // since the last diagnosis [s]

  std::mutex one_reset_;
  // True while the node waits for a person to bring the robot to its initial state.
  std::atomic<bool> person_asked_{false};
  image_transport::ImageTransport transport_;
  image_transport::Publisher image_pub_;
  ros::Publisher goal_pub_;
  ros::Publisher effort_pub_;
  ros::Publisher applied_pub_;
  ros::Publisher latency_pub_;
  ros::Publisher misses_pub_;
  ros::Publisher cancel_pub_;
  ros::Publisher enabled_pub_;
  image_transport::Subscriber camera_sub_;
  ros::Subscriber torque_sub_;
  ros::Subscriber joints_sub_;  // only if joints have limits
  ros::Subscriber trial_end_sub_;
  ros::SteadyTimer timer_;
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer diagnosis_timer_;
  ros::ServiceServer enable_server_;
  ros::ServiceServer take_goal_server_;
  ros::ServiceServer reset_done_server_;
  ros::ServiceServer reset_server_;
};

}  // namespace ddm
