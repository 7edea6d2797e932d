// Logs from callbacks that a stopped terminal must not block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/console.h>

#include <memory>
#include <string>

namespace ddm {

/// Logs in a thread of its own. rosconsole writes in the calling thread and holds a lock, so a
/// terminal that is stopped (Ctrl-S, a pager, a slow connection) blocks every thread that logs.
class LogThread {
 public:
  LogThread();
  /// Waits at most one second for lines that are not written yet.
  ~LogThread();
  LogThread(const LogThread&) = delete;
  LogThread& operator=(const LogThread&) = delete;

  /// These functions return at once. If 1000 lines are waiting, further lines are dropped.
  void info(const std::string& text) { add(ros::console::levels::Info, text); }
  void warn(const std::string& text) { add(ros::console::levels::Warn, text); }
  void error(const std::string& text) { add(ros::console::levels::Error, text); }

 private:
  struct Lines;

  void add(ros::console::levels::Level level, const std::string& text);

  std::shared_ptr<Lines> lines_;  // shared with the thread, which may outlive this object
};

}  // namespace ddm
