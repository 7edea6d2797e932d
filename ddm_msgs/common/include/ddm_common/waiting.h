// Limits for what ROS would wait for without end: services and simulated time.
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
#include <utility>

namespace ddm {

/// Calls a function in a thread of its own. It must own what it uses: where it does not return
/// within the limit, that thread is left behind.
/// @param check  called now and then meanwhile, to throw what ends the wait
/// @return what it returned; empty if it did not. Exceptions are passed on
template <class Function, class Check>
auto callWithin(std::chrono::duration<double> limit, Function function, const Check& check)
    -> std::optional<decltype(function())> {
  std::packaged_task<decltype(function())()> task(std::move(function));
  auto result = task.get_future();
  std::thread(std::move(task)).detach();
  const auto end = std::chrono::steady_clock::now() + limit;
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    check();
    if (std::chrono::steady_clock::now() > end) return std::nullopt;
  }
  return result.get();
}

template <class Function>
auto callWithin(std::chrono::duration<double> limit, Function function)
    -> std::optional<decltype(function())> {
  return callWithin(limit, std::move(function), [] {});
}

constexpr char kInterrupted[] = "interrupted; the same command resumes";

/// " (waited 60 s)"
std::string waited(double limit);

/// callWithin() that also ends on shutdown.
/// @param limit  wall time [s]
/// @throws std::runtime_error on shutdown
std::optional<bool> answerWithin(double limit, std::function<bool()> function);

/// Calls a service. To connect to it counts within the limit: a master that is stopped, or a host
/// that is gone, can take minutes for that.
/// @param name     resolved
/// @param client   the connection, made where there is none; kept for the next call. With one for
///                 each call the server hangs up after its answer, and a busy client may hear that
///                 first and lose the answer (github.com/ros/ros_comm/issues/1976)
/// @param service  request in, response out
/// @param limit    wall time [s]
/// @throws std::runtime_error naming the service if it does not answer, or reports no success
template <class Service>
void callService(const std::string& name, ros::ServiceClient* client, Service* service,
                 double limit) {
  struct Call {
    ros::ServiceClient client;
    Service service;
  };
  // Its thread alone uses it until there is an answer.
  const auto call = std::make_shared<Call>(Call{*client, *service});
  const auto success = answerWithin(limit, [call, name, nh = ros::NodeHandle()]() mutable {
    if (!call->client.isValid())
      call->client = nh.serviceClient<Service>(name, /*persistent=*/true);
    return call->client.call(call->service);
  });
  if (!success) {
    // The next call begins with a connection of its own. Not shutdown(): copies of a client share one
    // connection, and the thread that is left behind may be using it.
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

/// Waits until the first time on /clock is there, where /use_sim_time says that it is due. To be
/// called before an action client is made, which would wait without a limit.
/// @param limit  wall time [s]
/// @throws std::runtime_error after the limit, with those who should publish it
void waitForSimulatedTime(double limit);

}  // namespace ddm
