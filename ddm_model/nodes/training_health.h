// How model_node is doing, for /diagnostics: the training that runs, or how the last one ended.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/trainer.h>
#include <ddm_msgs/TrainResult.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <cstdint>
#include <mutex>
#include <string>

namespace ddm {

/// Publishes a status once in `~diagnostic_period` (1 s) of wall time. May be told of a training by
/// another thread.
class TrainingHealth {
 public:
  TrainingHealth(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) : updater_(nh, pnh) {
    status_.summary(Status::OK, "no model yet");
    updater_.setHardwareID("none");
    updater_.add("training", [this](Status& status) { report(&status); });
    // Not Updater::update(), which goes by simulated time: that stands still while a model is
    // trained.
    timer_ =
        nh.createSteadyTimer(ros::WallDuration(updater_.getPeriod()),
                             [this](const ros::SteadyTimerEvent&) { updater_.force_update(); });
  }

  void begin(std::uint32_t trial) {
    trial_ = trial;
    set(training(TrainingProgress()), ros::SteadyTime::now());
  }

  void progress(const TrainingProgress& progress) { set(training(progress), since_); }

  void succeed(const ddm_msgs::TrainResult& result) {
    Status status;
    status.summaryf(Status::OK, "trial %u: trained in %.2f s", trial_, result.train_time);
    status.add("model", result.model_id);
    status.add("frames learned from", result.frames);
    status.addf("V_R [grey^2]", "%.4g", result.v_r);
    status.addf("V_P [grey^2]", "%.4g", result.v_p);
    set(status, ros::SteadyTime::now());
  }

  /// Whoever has asked for the training has cancelled it.
  void cancel() {
    Status status;
    status.summaryf(Status::WARN, "trial %u: training cancelled", trial_);
    set(status, ros::SteadyTime::now());
  }

  void fail(const std::string& reason) {
    Status status;
    status.summary(Status::ERROR, "trial " + std::to_string(trial_) + ": " + reason);
    set(status, ros::SteadyTime::now());
  }

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  Status training(const TrainingProgress& progress) const {
    Status status;
    status.summaryf(Status::OK, "trial %u: training, %.0f %% of the iterations allowed", trial_,
                    100.0 * progress.fraction_done);
    status.add("iteration", progress.iteration);
    status.addf("V_R [grey^2]", "%.4g", progress.v_r);
    status.addf("V_P [grey^2]", "%.4g", progress.v_p);
    return status;
  }

  void set(Status status, const ros::SteadyTime& since) {
    status.add("trial", trial_);
    const std::lock_guard<std::mutex> lock(mutex_);
    status_ = status;
    since_ = since;
  }

  void report(Status* status) {
    const std::lock_guard<std::mutex> lock(mutex_);
    status->summary(status_);
    status->values = status_.values;
    if (!since_.isZero())
      status->addf("for [s]", "%.1f", (ros::SteadyTime::now() - since_).toSec());
  }

  std::uint32_t trial_ = 0;  // only the thread that trains knows it

  std::mutex mutex_;  // guards the next two
  Status status_;
  ros::SteadyTime since_;  // when the training began or ended; zero: there was none

  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace ddm
