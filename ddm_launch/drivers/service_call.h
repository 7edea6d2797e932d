// Calls of services that may be slow to answer, or to connect to.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

namespace ddm {

constexpr char kInterrupted[] = "interrupted; the same command resumes";

/// " (waited 60 s)"
std::string waited(double limit);

/// Calls a function in a thread of its own. It must own what it uses: where it does not return
/// within the limit, that thread is left behind.
/// @param limit  wall time [s]
/// @return what it returned; empty if it did not
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
    std::mutex mutex;  // guards the client
    ros::ServiceClient client;
    Service service;
  };
  const auto pending = std::make_shared<Call>();
  pending->client = *client;
  pending->service = *service;
  const auto call = [pending, name, nh = ros::NodeHandle()]() mutable {
    ros::ServiceClient connected = pending->client;
    if (!connected.isValid()) {
      connected = nh.serviceClient<Service>(name, /*persistent=*/true);
      const std::lock_guard<std::mutex> lock(pending->mutex);
      pending->client = connected;
    }
    return connected.call(pending->service);
  };
  std::optional<bool> success;
  try {
    success = answerWithin(limit, call);
    if (!success) throw std::runtime_error("service " + name + " does not answer" + waited(limit));
  } catch (const std::exception&) {
    const std::lock_guard<std::mutex> lock(pending->mutex);
    pending->client.shutdown();  // ends the call
    throw;
  }
  *client = pending->client;
  if (!*success) throw std::runtime_error("service " + name + " does not answer");
  *service = pending->service;
  if (!service->response.success) {
    throw std::runtime_error("service " + name + ": " + service->response.message);
  }
}

}  // namespace ddm
