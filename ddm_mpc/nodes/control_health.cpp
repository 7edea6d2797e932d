// Health of mpc_node on /diagnostics: camera, torque, plans, model.
// SPDX-License-Identifier: BSD-3-Clause
#include "control_health.h"

#include <ddm_common/option_checks.h>

#include <algorithm>

namespace ddm {
namespace {

constexpr double kLate = 1.0;  // a message that is missing for longer is a warning [s]

double ageOf(const ros::SteadyTime& time) { return (ros::SteadyTime::now() - time).toSec(); }

}  // namespace

ControlHealth::ControlHealth(const ros::NodeHandle& nh, const ros::NodeHandle& pnh)
    : last_report_(ros::SteadyTime::now()), updater_(nh, pnh) {
  updater_.setHardwareID("none");
  updater_.add("camera", [this](Status& status) { reportStream("image", images_, &status); });
  updater_.add("torque", [this](Status& status) { reportStream("torque", torques_, &status); });
  updater_.add("plan", [this](Status& status) { reportPlans(&status); });
  updater_.add("model", [this](Status& status) { reportModel(&status); });
  // Updater::update() uses simulated time, which may run a hundred times faster than real time.
  timer_ = nh.createSteadyTimer(ros::WallDuration(updater_.getPeriod()),
                                [this](const ros::SteadyTimerEvent&) { onTick(); });
}

void ControlHealth::expect(Expected expected) {
  const std::lock_guard<std::mutex> lock(mutex_);
  expected_ = expected;
  expected_since_ = ros::SteadyTime::now();
}

void ControlHealth::count(Stream* stream) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++stream->count;
  stream->last = ros::SteadyTime::now();
}

void ControlHealth::countPlan(const Plan& plan) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++plans_.count;
  plans_.failed += plan.status == PlanStatus::kFailed ? 1 : 0;
  plans_.cut += plan.status == PlanStatus::kTimeLimit ? 1 : 0;
  plans_.sum_s += plan.solve_time;
  plans_.max_s = std::max(plans_.max_s, plan.solve_time);
}

void ControlHealth::setModel(const ddm_msgs::Model& model) {
  const std::lock_guard<std::mutex> lock(mutex_);
  model_ = textOf("model ", model.id, " of trial ", model.trial, ", learned from ", model.frames,
                  " images");
}

void ControlHealth::onTick() {
  const std::lock_guard<std::mutex> lock(mutex_);
  period_ = ageOf(last_report_);
  last_report_ = ros::SteadyTime::now();
  updater_.force_update();
  plans_ = Plans();
  images_.count = torques_.count = 0;
}

void ControlHealth::reportStream(const char* name, const Stream& stream, Status* status) const {
  const double silence = ageOf(std::max(stream.last, expected_since_));
  if (expected_ == Expected::kImage && silence > kLate) {
    status->summaryf(Status::WARN, "no %s for %.1f s of a trial", name, silence);
  } else {
    status->summaryf(Status::OK, "%.1f %ss/s", stream.count / period_, name);
  }
}

void ControlHealth::reportPlans(Status* status) const {
  if (plans_.failed > 0) {
    status->summaryf(plans_.failed < plans_.count ? Status::WARN : Status::ERROR,
                     "%d of %d plans failed", plans_.failed, plans_.count);
  } else {
    const double mean_s = plans_.count > 0 ? plans_.sum_s / plans_.count : 0.0;
    status->summaryf(Status::OK, "%d plans, %.2f ms each, at most %.2f ms, %d cut short",
                     plans_.count, 1e3 * mean_s, 1e3 * plans_.max_s, plans_.cut);
  }
}

void ControlHealth::reportModel(Status* status) const {
  const double waited = ageOf(expected_since_);
  if (expected_ == Expected::kModel && waited > kLate) {
    status->summaryf(Status::WARN, "a trial has been waiting for its model for %.1f s", waited);
  } else {
    status->summary(Status::OK, model_);
  }
}

}  // namespace ddm
