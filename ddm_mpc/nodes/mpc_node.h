// mpc_node: answers each camera image with a torque.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib/server/simple_action_server.h>
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
#include "trial_run.h"

namespace ddm {

/// Action `run_trial`: publishes a torque on `torque` for each image of the trial, with the stamp
/// of the image. One thread handles images: it prepares trials, plans, and reads applied torques.
/// The thread that spins the global queue handles everything else, such as cancelled goals and
/// timeouts, so that neither a plan nor a preparation delays them.
class MpcNode {
 public:
  /// @param nh          node handle of topics and action
  /// @param pnh         node handle of parameters
  /// @param image_size  width and height of the images after resizing [pixels]
  MpcNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const MpcOptions& mpc,
          const ControllerOptions& controller);
  ~MpcNode();

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

  /// Reason why a trial must end. An empty text means that nothing is wrong.
  struct Trouble {
    std::string text;
    std::string topic;  ///< topic whose publishers the message names; may be empty
  };

  // Called by the thread of the global queue.
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

  // Called by the image thread.
  void prepare();
  std::shared_ptr<TrialRun> preparedTrial();
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void answer(const sensor_msgs::Image& image);
  std::optional<Decision> decide(TrialRun* trial, const sensor_msgs::ImageConstPtr& new_goal,
                                 const sensor_msgs::Image& image,
                                 std::chrono::steady_clock::time_point arrival);
  void publish(const std_msgs::Header& header, const Decision& decision);
  void publishTorque(const ros::Time& stamp, const Eigen::VectorXd& torque, bool exploratory);

  LogThread log_;  // so that a stopped terminal cannot delay a torque
  const int image_size_;
  const MpcOptions mpc_;
  const ControllerOptions controller_;

  // Used only by the thread of the global queue.
  std::shared_ptr<const Ddm> model_;
  std::string model_id_;
  ddm_msgs::RunTrialGoalConstPtr goal_;  // null: no trial
  std::uint32_t fed_back_ = 0;           // steps in the last feedback

  // Used only by the image thread.
  // Not yet answered; may belong to a trial whose goal is still to come. Null: none
  sensor_msgs::ImageConstPtr last_image_;
  Eigen::VectorXd predicted_;  // feature of the next image by the last plan; empty: unknown
  ros::SteadyTime last_plan_log_;

  // Guards the members up to deciding_since_. Not held while a plan is computed.
  std::mutex mutex_;
  sensor_msgs::ImageConstPtr goal_image_;  // the newest; null: none received
  bool goal_changed_ = false;              // goal_image_ is newer than the goal of the trial
  std::shared_ptr<TrialRun> trial_;        // null: no trial, or its model or goal image is missing
  bool preparing_ = false;                 // whether trial_ still needs prepare()
  std::optional<Trouble> finished_;        // set if the image thread has ended the trial
  ros::SteadyTime last_progress_;
  std::optional<ros::SteadyTime> deciding_since_;

  AppliedTorques applied_;
  ros::CallbackQueue image_queue_;
  image_transport::ImageTransport transport_;
  ros::Publisher torque_pub_;
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
  // Last member: its destructor stops the image thread before other members are destroyed.
  ros::AsyncSpinner image_spinner_;
};

}  // namespace ddm
