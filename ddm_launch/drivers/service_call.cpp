// Calls of services that may be slow to answer, or to connect to.
// SPDX-License-Identifier: BSD-3-Clause
#include "service_call.h"

#include <chrono>
#include <future>
#include <sstream>
#include <thread>
#include <utility>

namespace ddm {
namespace {

constexpr std::chrono::milliseconds kShutdownCheck(20);

}  // namespace

std::string waited(double limit) {
  std::ostringstream text;
  text << " (waited " << limit << " s)";
  return text.str();
}

std::optional<bool> answerWithin(double limit, std::function<bool()> function) {
  std::packaged_task<bool()> task(std::move(function));
  std::future<bool> answer = task.get_future();
  std::thread(std::move(task)).detach();
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
  while (answer.wait_for(kShutdownCheck) != std::future_status::ready) {
    if (!ros::ok()) throw std::runtime_error(kInterrupted);
    if (std::chrono::steady_clock::now() > end) return std::nullopt;
  }
  return answer.get();
}

}  // namespace ddm
