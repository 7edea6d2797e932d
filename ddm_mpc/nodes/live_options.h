// Options of the planner that a user turns while mpc_node runs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/MpcConfig.h>
#include <dynamic_reconfigure/server.h>
#include <ros/ros.h>

#include <functional>

#include "ddm_mpc/mpc_options.h"

namespace ddm {

/// dynamic_reconfigure for `mpc/epsilon`, `mpc/control_weight` and `mpc/horizon`: the names of the
/// parameters, which always hold what is in force. At the start nothing changes. Later values are
/// brought into their ranges by dynamic_reconfigure; those without a place in them are refused.
class LiveOptions {
 public:
  /// @param options  all of the block, after a change
  using Callback = std::function<void(const MpcOptions& options)>;

  /// @param nh       namespace of the block `mpc`
  /// @param options  values in force, valid
  LiveOptions(const ros::NodeHandle& nh, const MpcOptions& options, Callback on_change);

 private:
  void onRequest(ddm_mpc::MpcConfig* config);

  MpcOptions options_;
  Callback on_change_;
  dynamic_reconfigure::Server<ddm_mpc::MpcConfig> server_;
};

}  // namespace ddm
