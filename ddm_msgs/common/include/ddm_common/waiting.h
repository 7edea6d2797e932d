// Time limits for ROS calls that could block without end: services and simulated time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>

#include "ddm_common/option_checks.h"
#include "ddm_common/topic_peers.h"

namespace ddm {

/// Calls a function in a thread of its own. If the function does not return within the limit, the
/// thread is left running, so the function must own all data that it uses.
/// @param limit  wall time [s]
/// @param check  called every 20 ms while waiting; may throw to end the wait
/// @return the result of the function; empty if the function did not return in time. Exceptions of
///         the function are passed on
template <class Function>
std::optional<std::invoke_result_t<Function>> callWithin(
    std::chrono::duration<double> limit, Function function,
    const std::function<void()>& check = [] {}) {
  std::packaged_task<std::invoke_result_t<Function>()> task(std::move(function));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  const auto end = std::chrono::steady_clock::now() + limit;
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    check();
    if (std::chrono::steady_clock::now() > end) return std::nullopt;
  }
  return result.get();
}

constexpr char kInterrupted[] = "interrupted; the same command resumes";

/// Formats a limit [s] as " (waited 60 s)", for messages.
inline std::string waited(double limit) { return textOf(" (waited ", limit, " s)"); }

/// As callWithin(); also ends on shutdown.
/// @param limit  wall time [s]
/// @return the result of the function; empty after the limit
/// @throws std::runtime_error on shutdown
inline std::optional<bool> answerWithin(double limit, std::function<bool()> function) {
  return callWithin(std::chrono::duration<double>(limit), std::move(function), [] {
    if (!ros::ok()) throw std::runtime_error(kInterrupted);
  });
}

/// Calls a service. The limit includes the time to connect, because a connection to a stopped
/// master or an unreachable host can take minutes.
/// @param name     resolved name of the service
/// @param client   connection; made if it is not valid, and kept for the next call. With a new
///         connection for each call, the server closes the connection after its answer, and a busy
///         client may see the closed connection first and lose the answer
///         (github.com/ros/ros_comm/issues/1976)
/// @param service  in: request; out: response
/// @param limit    wall time [s]
/// @throws std::runtime_error with the name of the service if it does not answer or reports no
///         success
template <class Service>
void callService(const std::string& name, ros::ServiceClient* client, Service* service,
                 double limit) {
  struct Call {
    ros::ServiceClient client;
    Service service;
  };
  // Only the thread of the call uses this object until there is an answer.
  const auto call = std::make_shared<Call>(Call{*client, *service});
  const auto success = answerWithin(limit, [call, name, nh = ros::NodeHandle()]() mutable {
    if (!call->client.isValid())
      call->client = nh.serviceClient<Service>(name, /*persistent=*/true);
    return call->client.call(call->service);
  });
  if (!success) {
    // The next call makes a new connection. Do not call shutdown() here: copies of a client share
    // one connection, and the thread that is left running may still use it.
    *client = ros::ServiceClient();
    throw std::runtime_error("service " + name + " does not answer" + waited(limit));
  }
  *client = call->client;
  if (!*success) throw std::runtime_error("service " + name + " does not answer");
  *service = call->service;
  if (!service->response.success) {
    throw std::runtime_error("service " + name + ": " + service->response.message);
  }
}

/// If /use_sim_time is set, waits for the first message on /clock. Call this function before the
/// construction of an action client, which would wait without a limit.
/// @param limit  wall time [s]
/// @throws std::runtime_error after the limit, with the nodes that publish /clock
inline void waitForSimulatedTime(double limit) {
  if (ros::Time::waitForValid(ros::WallDuration(limit)) || !ros::ok()) return;
  throw std::runtime_error("simulated time does not come" + waited(limit) + ", " +
                           describePublishers("/clock"));
}

}  // namespace ddm
