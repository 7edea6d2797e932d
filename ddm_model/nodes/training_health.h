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
  TrainingHealth(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

  void begin(std::uint32_t trial);
  void progress(const TrainingProgress& progress);
  void succeed(const ddm_msgs::TrainResult& result);
  /// Whoever has asked for the training has cancelled it.
  void cancel();
  void fail(const std::string& reason);

 private:
  enum class State { kUntrained, kTraining, kTrained, kCancelled, kFailed };
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  void set(State state);
  void report(Status* status) const;

  mutable std::mutex mutex_;  // guards what follows, up to the updater
  State state_ = State::kUntrained;
  ros::WallTime since_;  // of the state
  std::uint32_t trial_ = 0;
  TrainingProgress progress_;
  ddm_msgs::TrainResult result_;
  std::string failure_;

  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace ddm
