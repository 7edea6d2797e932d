// model_node: trains a model from the recorded bags and publishes the model.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib/server/simple_action_server.h>
#include <ddm_bag_io/bag_cache.h>
#include <ddm_bag_io/model_config.h>
#include <ddm_bag_io/model_message.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/run_node.h>
#include <ddm_model/minimise.h>
#include <ddm_model/trainer.h>
#include <ddm_msgs/TrainAction.h>
#include <ddm_msgs/topics.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <cmath>
#include <cstdint>
#include <mutex>
#include <string>

namespace ddm {
namespace {

const ros::WallDuration kFeedbackPeriod(0.05);

using Status = diagnostic_updater::DiagnosticStatusWrapper;

/// Health of this node on /diagnostics: the running training, or the end of the last one. Published
/// once per `~diagnostic_period` (1 s) of wall time.
class TrainingHealth {
 public:
  TrainingHealth(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) : updater_(nh, pnh) {
    updater_.setHardwareID("none");
    updater_.add("training", [this](Status& status) {
      const std::lock_guard<std::mutex> lock(mutex_);
      status.summary(level_, text_);
    });
    // Updater::update() uses simulated time, which stands still during a training.
    timer_ =
        nh.createSteadyTimer(ros::WallDuration(updater_.getPeriod()),
                             [this](const ros::SteadyTimerEvent&) { updater_.force_update(); });
  }

  /// Sets the status; any thread may call this function.
  void set(std::uint8_t level, std::uint32_t trial, const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    level_ = level;
    text_ = "trial " + std::to_string(trial) + ": " + text;
  }

 private:
  std::mutex mutex_;  // guards level_ and text_
  std::uint8_t level_ = Status::OK;
  std::string text_ = "no model yet";
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

/// Action `train`: trains a model from bags and publishes it on the latched topic `model`.
class ModelNode {
 public:
  /// @param nh   node handle of topics and action
  /// @param pnh  node handle of parameters
  ModelNode(ros::NodeHandle nh, const ros::NodeHandle& pnh, const ModelConfig& config)
      : config_(config),
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
    trial_ = goal->trial;
    health_.set(Status::OK, trial_, "reads bags");
    try {
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
        health_.set(Status::ERROR, trial_, training.message);
        server_.setAborted(result, training.message);
      } else {
        result.model = toMessage(*training.model, ros::Time::now());
        model_pub_.publish(result.model);
        const std::string text =
            textOf("trained on ", result.model.frames, " frames in ", result.train_time, " s, V_R ",
                   result.model.v_r, " grey^2, V_P ", result.model.v_p, " grey^2");
        ROS_INFO_STREAM("trial " << goal->trial << ": " << text);
        health_.set(Status::OK, trial_, text);
        server_.setSucceeded(result);
      }
    } catch (const ReadingCancelled& e) {
      cancel(result, e.what());
    } catch (const std::exception& e) {
      ROS_ERROR_STREAM("trial " << goal->trial << ": cannot train: " << e.what());
      health_.set(Status::ERROR, trial_, e.what());
      server_.setAborted(result, e.what());
    }
  }

  void cancel(const ddm_msgs::TrainResult& result, const std::string& message) {
    health_.set(Status::WARN, trial_, "training cancelled");
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
    health_.set(Status::OK, trial_,
                textOf("training, ", std::lround(100.0 * progress.fraction_done),
                       " % of the iterations allowed, V_R ", progress.v_r, " grey^2, V_P ",
                       progress.v_p, " grey^2"));
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

  /// @return false if the client has cancelled the training or the node shuts down
  bool isWanted() { return ros::ok() && !server_.isPreemptRequested(); }

  ModelConfig config_;
  BagCache bags_;
  TrainingHealth health_;
  std::uint32_t trial_ = 0;
  ros::Publisher model_pub_;
  ros::SteadyTime last_feedback_;
  actionlib::SimpleActionServer<ddm_msgs::TrainAction> server_;
};

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  return ddm::runNode("model_node", argc, argv, [](auto nh, auto pnh, ddm::ParamReader* params) {
    params->ignore("diagnostic_period");  // diagnostic_updater reads it
    const ddm::ModelConfig config = ddm::readModelConfig(params);
    params->requireValid();
    ROS_INFO_STREAM("model_node runs with\n" << ddm::toText(config));
    ddm::ModelNode node(nh, pnh, config);
    ros::spin();
  });
}
