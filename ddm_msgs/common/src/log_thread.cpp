// Logs from callbacks that a stopped terminal must not block.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/log_thread.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

namespace ddm {
namespace {

constexpr std::size_t kMostLines = 1000;
constexpr std::chrono::seconds kLastLines(1);

}  // namespace

struct LogThread::Lines {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::pair<ros::console::levels::Level, std::string>>
      waiting;  // the first line is being written
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

LogThread::LogThread() : lines_(std::make_shared<Lines>()) {
  std::thread([lines = lines_] { lines->write(); }).detach();
}

LogThread::~LogThread() {
  std::unique_lock<std::mutex> lock(lines_->mutex);
  lines_->ended = true;
  lines_->changed.notify_all();
  lines_->changed.wait_for(lock, kLastLines, [this] { return lines_->waiting.empty(); });
}

void LogThread::add(ros::console::levels::Level level, const std::string& text) {
  const std::lock_guard<std::mutex> lock(lines_->mutex);
  if (lines_->waiting.size() >= kMostLines) return;
  lines_->waiting.emplace_back(level, text);
  lines_->changed.notify_all();
}

}  // namespace ddm
