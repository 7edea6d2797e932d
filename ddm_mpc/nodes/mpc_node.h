// mpc_node: answers camera images with torques.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib/server/simple_action_server.h>
#include <ddm_common/effort_publisher.h>
#include <ddm_common/log_thread.h>
#include <ddm_model/ddm.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <image_transport/image_transport.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "applied_torques.h"
#include "control_health.h"
#include "ddm_mpc/mpc_options.h"
#include "plan_messages.h"
#include "trial_run.h"

namespace ddm {

/// Action `run_trial`: each image of the trial is answered on `torque` with the image's stamp.
/// Images have a thread of their own, which prepares trials, plans, and takes in the applied torques. Everything else, such as
/// a goal that is cancelled, a trial that times out or Ctrl-C, is handled by the thread that spins the global queue, so that
/// neither a plan nor a preparation delays it.
class MpcNode {
 public:
  /// @param nh   topics and action
  /// @param pnh  parameters
  MpcNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const MpcOptions& mpc,
          const ControllerOptions& controller);
  ~MpcNode();

  /// Ends a trial under way, with zero torque to every motor.
  /// @return false if there is none
  bool stop();

 private:
  /// Runs a function on the thread of a callback queue.
  class Callback : public ros::CallbackInterface {
   public:
    explicit Callback(std::function<void()> function) : function_(std::move(function)) {}
    CallResult call() override {
      function_();
      return Success;
    }

   private:
    std::function<void()> function_;
  };

  /// Why a trial cannot go on; no text: nothing is wrong.
  struct Trouble {
    std::string text;
    std::string topic;  ///< whose publishers are to be named; may be empty
  };

  // In the thread of the global queue.
  void onGoal();
  void onPreempt();
  void onGoalImage(const sensor_msgs::ImageConstPtr& image);
  void onModel(const ddm_msgs::ModelConstPtr& message);
  void onTick();
  void onFinish();
  void beginIfReady(std::unique_lock<std::mutex> lock);
  std::optional<Trouble> describeSilence();
  ddm_msgs::RunTrialResult endTrial();
  void abort(const Trouble& trouble);

  // In the thread of the images.
  void prepare();
  std::shared_ptr<TrialRun> preparedTrial();
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void answer(const sensor_msgs::Image& image);
  std::optional<Decision> decide(TrialRun* trial, const sensor_msgs::ImageConstPtr& new_goal,
                                 const sensor_msgs::Image& image,
                                 std::chrono::steady_clock::time_point arrival);
  void publish(const std_msgs::Header& header, const Decision& decision);
  void publishTorque(const ros::Time& stamp, const Eigen::VectorXd& torque, bool exploratory);

  LogThread log_;  // a terminal that is stopped must not be in the way of a stop
  const int image_size_;
  const MpcOptions mpc_;
  const ControllerOptions controller_;

  // Of the thread of the global queue.
  std::shared_ptr<const Ddm> model_;
  std::string model_id_;
  ddm_msgs::RunTrialGoalConstPtr goal_;  // null: no trial
  std::uint32_t fed_back_ = 0;           // steps in the last feedback

  // Of the thread of the images.
  sensor_msgs::ImageConstPtr last_image_;  // may be the first of a trial whose goal is on its way
  PlanScalars scalars_;
  ros::SteadyTime last_plan_log_;

  std::mutex mutex_;  // not held while a plan is computed; guards these and effort_
  sensor_msgs::ImageConstPtr goal_image_;  // the newest; null: none came
  bool goal_changed_ = false;              // the trial plans to an older one
  std::shared_ptr<TrialRun> trial_;  // null: no trial, or its model or goal image has not come
  bool preparing_ = false;           // trial_, before its first image
  std::optional<Trouble> finished_;  // the thread of the images has ended the trial, and why
  ros::SteadyTime last_progress_;
  std::optional<ros::SteadyTime> deciding_since_;

  AppliedTorques applied_;
  ros::CallbackQueue image_queue_;
  image_transport::ImageTransport transport_;
  ros::Publisher torque_pub_;
  std::optional<EffortPublisher> effort_;  // empty: robot_node or a simulator has the motors
  ros::Publisher plan_pub_;
  ros::Publisher scalars_pub_;
  image_transport::Subscriber image_sub_;
  ros::Subscriber model_sub_;
  ros::Subscriber goal_image_sub_;
  ros::SteadyTimer timer_;
  ControlHealth health_;
  actionlib::SimpleActionServer<ddm_msgs::RunTrialAction> server_;
  const ros::CallbackInterfacePtr prepare_;  // for image_queue_
  const ros::CallbackInterfacePtr finish_;   // for the global queue
  // Last: it ends before anything that it uses.
  ros::AsyncSpinner image_spinner_;
};

}  // namespace ddm
