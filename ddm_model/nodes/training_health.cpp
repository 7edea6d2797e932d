// How model_node is doing, for /diagnostics: the training that runs, or how the last one ended.
// SPDX-License-Identifier: BSD-3-Clause
#include "training_health.h"

namespace ddm {

using diagnostic_msgs::DiagnosticStatus;

TrainingHealth::TrainingHealth(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : updater_(nh, pnh) {
  set(State::kUntrained);
  updater_.setHardwareID("none");
  updater_.add("training", [this](Status& status) { report(&status); });
  // Not Updater::update(), which goes by simulated time: that stands still while a model is
  // trained.
  timer_ = nh.createWallTimer(ros::WallDuration(updater_.getPeriod()),
                              [this](const ros::WallTimerEvent&) { updater_.force_update(); });
}

void TrainingHealth::set(State state) {
  state_ = state;
  since_ = ros::WallTime::now();
}

void TrainingHealth::begin(std::uint32_t trial) {
  const std::lock_guard<std::mutex> lock(mutex_);
  set(State::kTraining);
  trial_ = trial;
  progress_ = TrainingProgress();
}

void TrainingHealth::progress(const TrainingProgress& progress) {
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_ = progress;
}

void TrainingHealth::succeed(const ddm_msgs::TrainResult& result) {
  const std::lock_guard<std::mutex> lock(mutex_);
  set(State::kTrained);
  result_ = result;
}

void TrainingHealth::cancel() {
  const std::lock_guard<std::mutex> lock(mutex_);
  set(State::kCancelled);
}

void TrainingHealth::fail(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  set(State::kFailed);
  failure_ = reason;
}

void TrainingHealth::report(Status* status) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double age = (ros::WallTime::now() - since_).toSec();
  switch (state_) {
    case State::kUntrained:
      status->summary(DiagnosticStatus::OK, "no model yet");
      return;
    case State::kTraining:
      status->summaryf(DiagnosticStatus::OK,
                       "trial %u: training, %.0f %% of the iterations allowed", trial_,
                       100.0 * progress_.fraction_done);
      status->add("iteration", progress_.iteration);
      status->addf("V_R [grey^2]", "%.4g", progress_.v_r);
      status->addf("V_P [grey^2]", "%.4g", progress_.v_p);
      break;
    case State::kTrained:
      status->summaryf(DiagnosticStatus::OK, "trial %u: trained in %.2f s", trial_,
                       result_.train_time);
      status->add("model", result_.model_id);
      status->add("frames learned from", result_.frames);
      status->addf("V_R [grey^2]", "%.4g", result_.v_r);
      status->addf("V_P [grey^2]", "%.4g", result_.v_p);
      break;
    case State::kCancelled:
      status->summaryf(DiagnosticStatus::WARN, "trial %u: training cancelled", trial_);
      break;
    case State::kFailed:
      status->summary(DiagnosticStatus::ERROR, "trial " + std::to_string(trial_) + ": " + failure_);
      break;
  }
  status->add("trial", trial_);
  status->addf("for [s]", "%.1f", age);
}

}  // namespace ddm
