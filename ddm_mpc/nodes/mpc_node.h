// mpc_node: answers camera images with torques.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib/server/simple_action_server.h>
#include <ddm_model/ddm.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/RunTrialAction.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>

#include <memory>
#include <optional>
#include <string>

#include "control_health.h"
#include "controller_options.h"
#include "ddm_mpc/mpc_options.h"
#include "effort_publisher.h"
#include "live_options.h"
#include "plan_scalars.h"
#include "trial_run.h"

namespace ddm {

/// Action `run_trial`: each image of the trial is answered on `torque` with the image's stamp. For
/// a single-threaded spinner: all callbacks run one after the other.
class MpcNode {
 public:
  /// @param nh   topics and action
  /// @param pnh  parameters
  MpcNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const MpcOptions& mpc,
          const ControllerOptions& controller);

 private:
  void onGoal();
  void onPreempt();
  void onModel(const ddm_msgs::ModelConstPtr& message);
  void onImage(const sensor_msgs::ImageConstPtr& image);
  void onTick();
  void onTurn(const MpcOptions& mpc);

  void beginIfReady();
  void answer(const sensor_msgs::Image& image);
  void publish(const std_msgs::Header& header, const Decision& decision);
  void publishTorque(const ros::Time& stamp, const Eigen::VectorXd& torque, bool exploratory);
  void publishPlan(const ros::Time& stamp, const Plan& plan);
  ddm_msgs::RunTrialResult endTrial();
  void abort(const std::string& reason);

  int image_size_;
  MpcOptions mpc_;
  ControllerOptions controller_;
  std::optional<double> turned_epsilon_;  // empty: nobody has turned it, that of the goal counts
  std::shared_ptr<const Ddm> model_;
  std::string model_id_;
  ddm_msgs::RunTrialGoalConstPtr goal_;    // null: no trial
  std::unique_ptr<TrialRun> trial_;        // null: still waiting for the model
  sensor_msgs::ImageConstPtr last_image_;  // may be the first of a trial whose goal is on its way
  ros::WallTime last_progress_;
  ros::WallTime last_feedback_;
  PlanScalars scalars_;

  image_transport::ImageTransport transport_;
  ros::Publisher torque_pub_;
  EffortPublisher effort_;
  ros::Publisher plan_pub_;
  ros::Publisher scalars_pub_;
  image_transport::Subscriber image_sub_;
  ros::Subscriber model_sub_;
  ros::WallTimer timer_;
  LiveOptions live_;
  ControlHealth health_;
  actionlib::SimpleActionServer<ddm_msgs::RunTrialAction> server_;
};

}  // namespace ddm
