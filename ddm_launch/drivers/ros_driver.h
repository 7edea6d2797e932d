// ROS nodes as the driver: plant, recorder, trainer and policy behind services and actions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib/client/simple_action_client.h>
#include <ddm_msgs/Model.h>
#include <ddm_msgs/Reset.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/TrainAction.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "driver.h"

namespace ddm {

/// Orders the nodes about; computes nothing. All waits go by the monotonic clock, because simulated
/// time stands still while a model is trained and wall time can be set, and all end with an error
/// that names who is silent.
/// Callbacks, except those of ground truth, are handled in threads of its own; progress is reported
/// by the thread that waits.
class RosDriver : public Driver {
 public:
  struct Peers {
    bool recorder = true;  ///< trials are recorded
    bool trainer = true;   ///< models are trained
    /// Wall time that the robot itself allows for a reset [s]: a person may have to put it back.
    double reset_timeout = 0.0;
  };

  /// Waits until the nodes are there and connected to each other.
  /// @param timeout  wall time without a sign of life [s]
  /// @throws std::runtime_error naming what is missing
  RosDriver(const ros::NodeHandle& nh, double timeout, Peers peers);
  RosDriver(const RosDriver&) = delete;
  RosDriver& operator=(const RosDriver&) = delete;

  TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) override;
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override;

  /// Publishes it, until the trainer publishes its own.
  bool useModel(const std::string& path) override;

 private:
  void connect();
  void startRecording(const std::string& bag, const ros::Time& after);
  void stopRecording(int num_steps, const ros::Time& last, const ros::Time& goal);
  ddm_msgs::Reset::Response reset(const TrialRequest& request);
  ddm_msgs::RunTrialResult runPolicy(const TrialRequest& request,
                                     const ddm_msgs::Reset::Response& begin,
                                     const PhaseCallback& progress);
  void takeGroundTruth(const std::vector<ros::Time>& stamps, TrialOutcome* outcome);
  std::string takeModel(const std::string& model_id);

  template <class Client, class Goal, class FractionOf>
  auto execute(Client* client, const std::string& name, const Goal& goal,
               const FractionOf& fraction_of, const PhaseCallback& progress);
  template <class Service>
  void call(const char* topic, Service* service, double limit);
  void refuseIntruders() const;
  void signOfLife();
  void waitFor(const std::function<bool()>& condition, const std::function<std::string()>& what);

  ros::CallbackQueue callbacks_;
  ros::NodeHandle nh_;  // with that queue
  /// Emptied now and then by the thread that waits: a thread of its own would wake for each frame.
  ros::CallbackQueue ground_truth_queue_;
  std::map<ros::Time, sensor_msgs::JointState> ground_truth_;  // of the last trial, by stamp
  bool keeps_ground_truth_ = false;                            // a trial is under way
  double timeout_;
  Peers peers_;
  std::string model_id_;
  ros::Time last_image_;  // of the last trial

  std::mutex mutex_;  // guards what callbacks write, below
  std::condition_variable changed_;
  ros::SteadyTime last_sign_of_life_;
  ddm_msgs::ModelConstPtr model_;

  actionlib::SimpleActionClient<ddm_msgs::RunTrialAction> trial_client_;
  actionlib::SimpleActionClient<ddm_msgs::TrainAction> train_client_;
  std::map<std::string, ros::ServiceClient> service_clients_;  // by topic, since the first call
  ros::Subscriber ground_truth_sub_;
  ros::Subscriber model_sub_;
  ros::Publisher model_pub_;   // of a saved model
  ros::AsyncSpinner spinner_;  // last: begins when all of the above is there, and ends first
};

}  // namespace ddm
