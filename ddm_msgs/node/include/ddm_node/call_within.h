// Calls that may never return, with a limit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <future>
#include <optional>
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

}  // namespace ddm
