// model_node: trains a model from the recorded bags and publishes it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib/server/simple_action_server.h>
#include <ddm_bag_io/bag_access.h>
#include <ddm_bag_io/bag_cache.h>
#include <ddm_bag_io/model_config.h>
#include <ddm_model/trainer.h>
#include <ddm_msgs/TrainAction.h>
#include <ros/ros.h>

#include "training_health.h"

namespace ddm {

/// Action `train` -> topic `model`, latched.
class ModelNode {
 public:
  /// @param nh   topics and action
  /// @param pnh  parameters
  ModelNode(ros::NodeHandle nh, ros::NodeHandle pnh, const ModelConfig& config,
            const BagAccess& access);

 private:
  void train(const ddm_msgs::TrainGoalConstPtr& goal);
  TrainingResult trainOn(const DataSet& data, const ddm_msgs::TrainGoal& goal);
  bool reportProgress(const TrainingProgress& progress);
  void publish(const Ddm& model, ddm_msgs::TrainResult* result);

  ModelConfig config_;
  BagAccess access_;
  BagCache bags_;
  TrainingHealth health_;
  ros::Publisher model_pub_;
  ros::WallTime last_feedback_;
  actionlib::SimpleActionServer<ddm_msgs::TrainAction> server_;
};

}  // namespace ddm
