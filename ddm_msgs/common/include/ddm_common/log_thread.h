// Log lines of callbacks that must not wait for a terminal.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/console.h>

#include <memory>
#include <string>

namespace ddm {

/// Logs in a thread of its own. rosconsole writes in the thread that logs, one thread at a time, so
/// a terminal that is stopped (Ctrl-S, a pager, a slow connection) holds up whoever logs.
class LogThread {
 public:
  LogThread();
  /// Waits a second at most for lines that are not written yet.
  ~LogThread();
  LogThread(const LogThread&) = delete;
  LogThread& operator=(const LogThread&) = delete;

  /// Return at once. Where 1000 lines wait, more are dropped.
  void info(const std::string& text) { add(ros::console::levels::Info, text); }
  void warn(const std::string& text) { add(ros::console::levels::Warn, text); }
  void error(const std::string& text) { add(ros::console::levels::Error, text); }

 private:
  struct Lines;

  void add(ros::console::levels::Level level, const std::string& text);

  std::shared_ptr<Lines> lines_;  // shared with the thread, which may outlive this
};

}  // namespace ddm
