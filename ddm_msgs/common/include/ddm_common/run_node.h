// main() of a node: parameters, then the node, and one way out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/console.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "ddm_common/node_params.h"
#include "ddm_common/param_reader.h"
#include "ddm_common/topic_peers.h"

namespace ddm {

namespace internal {

inline std::atomic<bool> end_requested{false};

inline void onSignal(int /*signal*/) { end_requested = true; }

/// The master's `shutdown`: of `rosnode kill`, and where another node takes the name.
inline void onShutdownRequest(XmlRpc::XmlRpcValue& params, XmlRpc::XmlRpcValue& result) {
  end_requested = true;
  result = ros::xmlrpc::responseInt(1, "", 0);
  if (params.getType() == XmlRpc::XmlRpcValue::TypeArray && params.size() > 1) {
    ROS_WARN_STREAM("asked to end: " << static_cast<std::string>(params[1]));
  }
}

/// The process ends ten seconds from now at the latest, whatever then still waits for a master or a
/// terminal that was stopped.
inline void endSoon(int code) {
  std::thread([code] {
    std::this_thread::sleep_for(std::chrono::seconds(10));
    std::_Exit(code);
  }).detach();
}

/// roscpp sends and logs on the same thread, for instance when a subscriber has another message
/// type. A stopped terminal would block that thread, and with it every zero torque. The node's own
/// messages remain, and so do those of the other side.
inline void silenceSendingThread() {
  ros::console::set_logger_level("ros.roscpp", ros::console::levels::Fatal);
  ros::console::notifyLoggerLevelsChanged();
}

}  // namespace internal

/// What a node does when it is asked to end.
enum class Ending {
  kAtOnce,        ///< roscpp shuts down whatever it is doing
  kByLastMessage  ///< it runs in runUntilEnd(), and sends a last message
};

/// Runs a node with motors until SIGINT, SIGTERM, SIGQUIT, SIGHUP (its terminal is closed; not under
/// nohup, which ignores it) or the master asks it to end. Ctrl-Z does nothing: it would leave the
/// motors with their last torque. roscpp's own handlers shut all topics down before a zero can be
/// sent: start the node with kByLastMessage.
///
/// @param look  called again and again; returns soon
/// @param stop  sends the last message; false: there was none to send
template <class Look, class Stop>
void runUntilEnd(const Look& look, const Stop& stop) {
  std::signal(SIGINT, internal::onSignal);
  std::signal(SIGTERM, internal::onSignal);
  std::signal(SIGQUIT, internal::onSignal);
  std::signal(SIGTSTP, SIG_IGN);
  if (std::signal(SIGHUP, internal::onSignal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  while (ros::ok() && !internal::end_requested) look();
  if (stop()) ros::WallDuration(0.1).sleep();  // for the message to leave
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
/// A node whose name is taken is refused, see requireFreeName().
///
/// @param run  (node handle, private node handle, reader of its parameters)
/// @return exit code: 1 if `run` threw an exception, whose text is logged. After `run`, the process
///         ends within ten seconds: ROS tells the master for each topic that it goes, and a master
///         that was stopped never answers
template <class Run>
int runNode(const std::string& name, int argc, char** argv, const Run& run,
            Ending ending = Ending::kAtOnce) {
  if (ending == Ending::kByLastMessage) {
    ros::init(argc, argv, name, ros::init_options::NoSigintHandler);
    // Before there is a node handle: with it, roscpp binds what is not bound yet.
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
