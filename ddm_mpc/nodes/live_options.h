// Options of the planner that a user turns while mpc_node runs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/MpcConfig.h>
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>

#include <functional>
#include <utility>

#include "ddm_mpc/mpc_options.h"

namespace ddm {

/// dynamic_reconfigure for `mpc/epsilon`, `mpc/control_weight` and `mpc/horizon`: the names of the
/// parameters, which hold what is in force (epsilon: that of each trial's goal, until somebody
/// turns it). At the start nothing changes. Later values are brought into their ranges by
/// dynamic_reconfigure; those without a place in them are refused.
class LiveOptions {
 public:
  /// @param options  all of the block, after a change
  using Callback = std::function<void(const MpcOptions& options)>;

  /// @param nh       namespace of the block `mpc`. The thread of its queue may wait for the master
  ///                 whenever an option is turned
  /// @param options  values in force, valid
  LiveOptions(const ros::NodeHandle& nh, const MpcOptions& options, Callback on_change)
      : options_(options), on_change_(std::move(on_change)), server_(withParameters(nh, options)) {
    server_.setCallback([this](MpcConfig& config, std::uint32_t) { onRequest(&config); });
  }

 private:
  using MpcConfig = ddm_mpc::MpcConfig;

  static void write(const MpcOptions& options, MpcConfig* config) {
    config->epsilon = options.epsilon;
    config->control_weight = options.control_weight;
    config->horizon = options.horizon;
  }

  /// The server takes its first values from the parameters, and its own defaults where one is
  /// missing or a text (as rosparam reads 1e-2): so they are written there first.
  static ros::NodeHandle withParameters(const ros::NodeHandle& nh, const MpcOptions& options) {
    MpcConfig config = MpcConfig::__getDefault__();
    write(options, &config);
    config.__toServer__(nh);
    return nh;
  }

  template <class Value>
  static void tell(const char* key, Value before, Value after, Value min, Value max) {
    if (before == after) return;
    ROS_INFO_STREAM("mpc/" << key << " is " << after << " from the next image on, was " << before
                           << " (range " << min << " to " << max << ")");
  }

  void onRequest(MpcConfig* config) {
    MpcOptions turned = options_;
    turned.epsilon = config->epsilon;
    turned.control_weight = config->control_weight;
    turned.horizon = config->horizon;
    const std::vector<std::string> problems = turned.problems();
    if (!problems.empty()) {
      for (const std::string& problem : problems) ROS_WARN_STREAM("nothing turned: " << problem);
      write(options_, config);
      return;
    }
    const MpcConfig min = MpcConfig::__getMin__(), max = MpcConfig::__getMax__();
    tell("epsilon", options_.epsilon, turned.epsilon, min.epsilon, max.epsilon);
    tell("control_weight", options_.control_weight, turned.control_weight, min.control_weight,
         max.control_weight);
    tell("horizon", options_.horizon, turned.horizon, min.horizon, max.horizon);
    options_ = turned;
    on_change_(options_);
  }

  MpcOptions options_;
  Callback on_change_;
  dynamic_reconfigure::Server<MpcConfig> server_;
};

}  // namespace ddm
