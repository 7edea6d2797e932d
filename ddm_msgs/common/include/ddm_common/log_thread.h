// Logs from callbacks that a stopped terminal must not block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/console.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace ddm {

/// Logs in a thread of its own. rosconsole writes in the calling thread and holds a lock, so a
/// terminal that is stopped (Ctrl-S, a pager, a slow connection) blocks every thread that logs.
class LogThread {
 public:
  LogThread() {
    std::thread([lines = lines_] { lines->write(); }).detach();
  }
  /// Waits at most one second for lines that are not written yet.
  ~LogThread() {
    std::unique_lock<std::mutex> lock(lines_->mutex);
    lines_->ended = true;
    lines_->changed.notify_all();
    lines_->changed.wait_for(lock, std::chrono::seconds(1),
                             [this] { return lines_->waiting.empty(); });
  }
  LogThread(const LogThread&) = delete;
  LogThread& operator=(const LogThread&) = delete;

  /// These functions return at once. If 1000 lines are waiting, further lines are dropped.
  void info(const std::string& text) { add(ros::console::levels::Info, text); }
  void warn(const std::string& text) { add(ros::console::levels::Warn, text); }
  void error(const std::string& text) { add(ros::console::levels::Error, text); }

 private:
  using Level = ros::console::levels::Level;

  struct Lines {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::pair<Level, std::string>> waiting;  // the first line is being written
    bool ended = false;

    void write() {
      std::unique_lock<std::mutex> lock(mutex);
      for (;;) {
        changed.wait(lock, [this] { return ended || !waiting.empty(); });
        if (waiting.empty()) return;
        const auto line = waiting.front();
        lock.unlock();
        ROS_LOG_STREAM(line.first, ROSCONSOLE_DEFAULT_NAME, line.second);
        lock.lock();
        waiting.pop_front();
        changed.notify_all();
      }
    }
  };

  void add(Level level, const std::string& text) {
    const std::lock_guard<std::mutex> lock(lines_->mutex);
    if (lines_->waiting.size() >= 1000) return;
    lines_->waiting.emplace_back(level, text);
    lines_->changed.notify_all();
  }

  // Shared with the thread, which may outlive this object.
  const std::shared_ptr<Lines> lines_ = std::make_shared<Lines>();
};

}  // namespace ddm
