// Driver that runs trials and trainings through the services and actions of ROS nodes.
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

/// Calls the nodes in the right order; computes nothing itself. All time limits use the monotonic
/// clock, because simulated time stands still during a training and wall time can be set. Each wait
/// ends with an error that names the silent node. Callbacks run in the threads of this object,
/// except those of ground truth. Progress is reported by the waiting thread.
class RosDriver : public Driver {
 public:
  /// Optional nodes that the driver uses, and a time limit of the robot.
  struct Peers {
    bool recorder = true;  ///< whether a node records the trials
    bool trainer = true;   ///< whether a node trains models
    /// Wall time that the robot allows for a reset [s]. A person may have to put the robot back.
    double reset_timeout = 0.0;
  };

  /// Waits until all nodes exist and are connected to each other.
  /// @param timeout  longest wall time without any message or progress [s]
  /// @throws std::runtime_error naming the missing nodes or connections
  RosDriver(const ros::NodeHandle& nh, double timeout, Peers peers);
  RosDriver(const RosDriver&) = delete;
  RosDriver& operator=(const RosDriver&) = delete;

  TrialOutcome runTrial(const TrialRequest& request, const PhaseCallback& progress) override;
  TrainingOutcome train(const std::vector<std::string>& bags, const TrialId& id,
                        const PhaseCallback& progress) override;

  /// Publishes a saved model. The trainer replaces the model after the next training.
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

  template <class Client, class Goal, class FractionOf>
  auto execute(Client* client, const std::string& name, const Goal& goal,
               const FractionOf& fraction_of, const PhaseCallback& progress);
  template <class Service>
  void call(const char* topic, Service* service, double limit);
  void refuseIntruders() const;
  void signOfLife();
  void waitFor(const std::function<bool()>& condition, const std::function<std::string()>& what);

  ros::CallbackQueue callbacks_;
  ros::NodeHandle nh_;  // uses `callbacks_`
  /// The waiting thread empties this queue from time to time. A thread of its own would wake up for
  /// each sample.
  ros::CallbackQueue ground_truth_queue_;
  std::map<ros::Time, sensor_msgs::JointState> ground_truth_;  // of the latest episode, by stamp
  bool keeps_ground_truth_ = false;                            // true while an episode runs
  double timeout_;
  Peers peers_;
  std::string model_id_;
  ros::Time last_image_;  // stamp of the last image of the latest episode

  std::mutex mutex_;  // guards the members that callbacks write, below
  std::condition_variable changed_;
  ros::SteadyTime last_sign_of_life_;

  actionlib::SimpleActionClient<ddm_msgs::RunTrialAction> trial_client_;
  actionlib::SimpleActionClient<ddm_msgs::TrainAction> train_client_;
  std::map<std::string, ros::ServiceClient> service_clients_;  // by topic, made by the first call
  ros::Subscriber ground_truth_sub_;
  ros::Publisher model_pub_;   // publishes a saved model
  ros::AsyncSpinner spinner_;  // last member: it must start after and stop before all others
};

}  // namespace ddm
