// main() of a node: parameters, then the node, and one way out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "ddm_node/node_params.h"
#include "ddm_params/param_reader.h"

namespace ddm {

namespace internal {

inline volatile std::sig_atomic_t end_requested = 0;

inline void requestEnd(int /*signal*/) { end_requested = 1; }

}  // namespace internal

/// From now on SIGINT and SIGTERM set endRequested() and do nothing else. roscpp's own handler
/// shuts all topics down before a zero can be sent to the motors: call ros::init() with
/// NoSigintHandler.
inline void catchEndSignals() {
  std::signal(SIGINT, internal::requestEnd);
  std::signal(SIGTERM, internal::requestEnd);
}

inline bool endRequested() { return internal::end_requested != 0; }

/// Runs a node until it ends.
///
///   return ddm::runNode("view_node", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
///     const auto image = params->read<ddm::ImageOptions>("image");
///     params->requireValid();
///     ddm::ViewNode node(nh, image.size);
///     ros::spin();
///   });
///
/// @param run      (node handle, private node handle, reader of its parameters)
/// @param options  ros::init_options
/// @return exit code: 1 if `run` threw an exception, whose text is logged. The process ends with it
///         ten seconds later at most: what belongs to ROS tells the master for each topic that it
///         goes, and a master that was stopped never answers
template <class Run>
int runNode(const std::string& name, int argc, char** argv, const Run& run,
            std::uint32_t options = 0) {
  ros::init(argc, argv, name, options);
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");  // outside the try: its destructor shuts the log down
  int code = EXIT_SUCCESS;
  try {
    ParamReader params(nodeParams(pnh), pnh.getNamespace());
    run(nh, pnh, &params);
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM(name << ": " << e.what());
    code = EXIT_FAILURE;
  }
  std::thread([code] {
    std::this_thread::sleep_for(std::chrono::seconds(10));
    std::_Exit(code);
  }).detach();
  return code;
}

}  // namespace ddm
