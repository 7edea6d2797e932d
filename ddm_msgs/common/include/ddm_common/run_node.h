// main() of a node: reads the parameters, runs the node, and handles errors and shutdown.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/console.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "ddm_common/node_params.h"
#include "ddm_common/param_reader.h"
#include "ddm_common/topic_peers.h"

namespace ddm {

namespace internal {

inline std::atomic<bool> end_requested{false};

inline void onSignal(int /*signal*/) { end_requested = true; }

/// Handles the method `shutdown`, which the master calls for `rosnode kill` and when another node
/// registers under the same name.
inline void onShutdownRequest(XmlRpc::XmlRpcValue& params, XmlRpc::XmlRpcValue& result) {
  end_requested = true;
  result = ros::xmlrpc::responseInt(1, "", 0);
  if (params.getType() == XmlRpc::XmlRpcValue::TypeArray && params.size() > 1) {
    ROS_WARN_STREAM("asked to end: " << static_cast<std::string>(params[1]));
  }
}

/// Ends the process after ten seconds, even if it is still blocked by a stopped master or terminal.
inline void endSoon(int code) {
  std::thread([code] {
    std::this_thread::sleep_for(std::chrono::seconds(10));
    std::_Exit(code);
  }).detach();
}

/// Silences roscpp's own log messages. roscpp sends and logs in the same thread, for instance if a
/// subscriber expects another message type, so a stopped terminal would block that thread and every
/// zero torque. The messages of the node itself and of the other node remain.
inline void silenceSendingThread() {
  ros::console::set_logger_level("ros.roscpp", ros::console::levels::Fatal);
  ros::console::notifyLoggerLevelsChanged();
}

/// Whether a process is suspended, as by Ctrl-Z.
inline bool isSuspended(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string status;
  std::getline(file, status);
  // PID (NAME) STATE ..., where the name may contain parentheses
  const std::string::size_type end = status.rfind(") ");
  return end != std::string::npos && status.compare(end + 2, 1, "T") == 0;
}

}  // namespace internal

/// How a node ends when the user or the master requests its end.
enum class Ending {
  kAtOnce,        ///< roscpp shuts down immediately
  kByLastMessage  ///< the node runs in runUntilEnd() and sends a last message
};

/// Runs a node with motors until SIGINT, SIGTERM, SIGQUIT, SIGHUP or the master requests its end, or
/// until the process that has started the node ends or is suspended. This process is roslaunch,
/// whose nodes would not notice that somebody has killed it or pressed Ctrl-Z. A closed terminal
/// sends SIGHUP, except under nohup. The node itself ignores Ctrl-Z, because a suspended node would
/// leave the motors with their last torque. roscpp's own signal handlers shut down all topics before
/// a zero torque can be sent, so start the node with kByLastMessage.
///
/// @param stop  sends the last message
template <class Stop>
void runUntilEnd(const Stop& stop) {
  std::signal(SIGINT, internal::onSignal);
  std::signal(SIGTERM, internal::onSignal);
  std::signal(SIGQUIT, internal::onSignal);
  std::signal(SIGTSTP, SIG_IGN);
  if (std::signal(SIGHUP, internal::onSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  const pid_t parent = getppid();
  const auto parent_runs = [parent] {
    return getppid() == parent && !internal::isSuspended(parent);
  };
  while (ros::ok() && !internal::end_requested && parent_runs()) {
    ros::WallDuration(0.05).sleep();
  }
  stop();
  // The log comes after the last message, because a stopped terminal would block it.
  if (!parent_runs()) {
    ROS_ERROR("the process that started this node has ended or is suspended: this node ends");
  }
  ros::WallDuration(0.1).sleep();  // gives the message time to leave
  internal::endSoon(EXIT_SUCCESS);
  ros::shutdown();
}

/// Runs a node until it ends.
///
///   return ddm::runNode("view_node", argc, argv, [](auto nh, auto, ddm::ParamReader* params) {
///     const auto image = params->read<ddm::ImageOptions>("image");
///     params->requireValid();
///     ddm::ViewNode node(nh, image.size);
///     ros::spin();
///   });
///
/// If another node with the same name is running, this node refuses to start, see
/// requireFreeName().
///
/// @param run  function of (node handle, private node handle, reader of the parameters)
/// @return exit code: 1 if `run` threw an exception, whose text is logged. The process ends at most
///         ten seconds after `run`: ROS unregisters each topic at the master, and a stopped master
///         never answers
template <class Run>
int runNode(const std::string& name, int argc, char** argv, const Run& run,
            Ending ending = Ending::kAtOnce) {
  if (ending == Ending::kByLastMessage) {
    ros::init(argc, argv, name, ros::init_options::NoSigintHandler);
    // Must come before the first node handle, which binds roscpp's own handler unless one is bound.
    ros::XMLRPCManager::instance()->bind("shutdown", internal::onShutdownRequest);
  } else {
    ros::init(argc, argv, name);
  }
  try {
    requireFreeName();
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM(name << ": " << e.what());
    return EXIT_FAILURE;
  }
  ros::NodeHandle nh;
  ros::NodeHandle pnh("~");  // outside the try: its destructor shuts the log down
  if (ending == Ending::kByLastMessage) internal::silenceSendingThread();
  int code = EXIT_SUCCESS;
  try {
    ParamReader params(nodeParams(pnh), pnh.getNamespace());
    run(nh, pnh, &params);
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM(name << ": " << e.what());
    code = EXIT_FAILURE;
  }
  internal::endSoon(code);
  return code;
}

}  // namespace ddm
