// model_node: trains a model from the recorded bags and publishes it.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib/server/simple_action_server.h>
#include <ddm_bag_io/bag_access.h>
#include <ddm_bag_io/bag_cache.h>
#include <ddm_bag_io/model_config.h>
#include <ddm_bag_io/model_message.h>
#include <ddm_model/solver_log.h>
#include <ddm_model/trainer.h>
#include <ddm_msgs/TrainAction.h>
#include <ddm_msgs/topics.h>
#include <ddm_node/run_node.h>
#include <ros/ros.h>

#include "training_health.h"

namespace ddm {
namespace {

const ros::WallDuration kFeedbackPeriod(0.05);

/// Action `train` -> topic `model`, latched.
class ModelNode {
 public:
  /// @param nh   topics and action
  /// @param pnh  parameters
  ModelNode(ros::NodeHandle nh, const ros::NodeHandle& pnh, const ModelConfig& config,
            const BagAccess& access)
      : config_(config),
        access_(access),
        bags_(config.image.size, config.data_set,
              [](const std::string& note) { ROS_WARN_STREAM(note); }),
        health_(nh, pnh),
        model_pub_(nh.advertise<ddm_msgs::Model>(topics::kModel, 1, /*latch=*/true)),
        server_(
            nh, topics::kTrain, [this](const ddm_msgs::TrainGoalConstPtr& goal) { train(goal); },
            /*auto_start=*/false) {
    server_.start();
  }

 private:
  void train(const ddm_msgs::TrainGoalConstPtr& goal) {
    ddm_msgs::TrainResult result;
    health_.begin(goal->trial);
    try {
      for (const std::string& bag : goal->bags) access_.require(bag);
      ROS_INFO("trial %u: reads %zu bags, then trains", goal->trial, goal->bags.size());
      const DataSet data = bags_.read(goal->bags, [this] { return isWanted(); });
      if (!data.hasGoal()) {
        ROS_WARN("no bag holds a goal image: the model can predict, but not be planned with");
      }
      const TrainingResult training = trainOn(data, *goal);
      result.train_time = training.seconds;
      result.evaluations = training.evaluations;
      if (training.cancelled) {
        cancel(result, training.message);
      } else if (!training.model) {
        ROS_ERROR_STREAM("trial " << goal->trial << ": " << training.message);
        health_.fail(training.message);
        server_.setAborted(result, training.message);
      } else {
        publish(*training.model, &result);
        ROS_INFO("trial %u: learned from %u frames in %.2f s, V_R %.4g, V_P %.4g", goal->trial,
                 result.frames, result.train_time, result.v_r, result.v_p);
        health_.succeed(result);
        server_.setSucceeded(result);
      }
    } catch (const ReadingCancelled& e) {
      cancel(result, e.what());
    } catch (const std::exception& e) {
      ROS_ERROR_STREAM("trial " << goal->trial << ": cannot train: " << e.what());
      health_.fail(e.what());
      server_.setAborted(result, e.what());
    }
  }

  void cancel(const ddm_msgs::TrainResult& result, const std::string& message) {
    health_.cancel();
    server_.setPreempted(result, message);
  }

  TrainingResult trainOn(const DataSet& data, const ddm_msgs::TrainGoal& goal) {
    ModelInfo info;
    info.seed = goal.seed;
    info.trial = goal.trial;
    info.config = toText(config_);
    return ddm::train(
        data, config_.model, config_.training, info,
        [this](const TrainingProgress& progress) { return reportProgress(progress); });
  }

  bool reportProgress(const TrainingProgress& progress) {
    health_.progress(progress);
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (now - last_feedback_ >= kFeedbackPeriod) {
      last_feedback_ = now;
      ddm_msgs::TrainFeedback feedback;
      feedback.iteration = progress.iteration;
      feedback.v_r = progress.v_r;
      feedback.v_p = progress.v_p;
      feedback.gradient_norm = progress.gradient_norm;
      feedback.fraction_done = progress.fraction_done;
      server_.publishFeedback(feedback);
    }
    return isWanted();
  }

  /// Whether nobody asked to end the training or this node.
  bool isWanted() { return ros::ok() && !server_.isPreemptRequested(); }

  void publish(const Ddm& model, ddm_msgs::TrainResult* result) {
    const ddm_msgs::Model message = toMessage(model, ros::Time::now());
    model_pub_.publish(message);
    result->model_id = message.id;
    result->frames = message.frames;
    result->v_r = message.v_r;
    result->v_p = message.v_p;
  }

  ModelConfig config_;
  BagAccess access_;
  BagCache bags_;
  TrainingHealth health_;
  ros::Publisher model_pub_;
  ros::SteadyTime last_feedback_;
  actionlib::SimpleActionServer<ddm_msgs::TrainAction> server_;
};

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  return ddm::runNode("model_node", argc, argv, [](auto nh, auto pnh, ddm::ParamReader* params) {
    params->ignore("diagnostic_period");  // read by diagnostic_updater itself
    const ddm::ModelConfig config = ddm::readModelConfig(params);
    const auto access = params->read<ddm::BagAccess>("access");
    params->requireValid();
    ROS_INFO_STREAM("model_node runs with\n" << ddm::toText(config));
    ddm::ModelNode node(nh, pnh, config, access);
    ros::spin();
  });
}
