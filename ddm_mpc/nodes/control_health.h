// Health of mpc_node on /diagnostics: camera, torque, plans, model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Model.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <mutex>
#include <string>

#include "ddm_mpc/planner.h"

namespace ddm {

/// Counts images, torques and plans, from any thread, and publishes four statuses once per
/// `~diagnostic_period` (1 s). All times are of the steady clock, because in lock-step simulated
/// time runs as fast as the computer allows.
class ControlHealth {
 public:
  /// The message that a trial needs next.
  enum class Expected { kNothing, kModel, kImage };

  ControlHealth(const ros::NodeHandle& nh, const ros::NodeHandle& pnh);

  void expect(Expected expected);
  void countImage() { count(&images_); }
  void countTorque() { count(&torques_); }
  void countPlan(const Plan& plan);
  void setModel(const ddm_msgs::Model& model);

 private:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;

  struct Stream {
    int count = 0;  ///< since the last report
    ros::SteadyTime last;
  };
  struct Plans {
    int count = 0;
    int failed = 0;
    int cut = 0;  ///< stopped by mpc/time_budget
    double sum_s = 0.0;
    double max_s = 0.0;
  };

  void count(Stream* stream);
  void onTick();
  void reportStream(const char* name, const Stream& stream, Status* status) const;
  void reportPlans(Status* status) const;
  void reportModel(Status* status) const;

  std::mutex mutex_;  // guards the members up to model_
  Expected expected_ = Expected::kNothing;
  ros::SteadyTime expected_since_;
  ros::SteadyTime last_report_;
  double period_ = 0.0;  ///< time between the last two reports [s]
  Stream images_;
  Stream torques_;
  Plans plans_;  ///< since the last report
  std::string model_ = "no model yet";

  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace ddm
