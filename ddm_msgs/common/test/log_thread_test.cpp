// Tests of logging in a separate thread.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/log_thread.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

#include "ddm_common/waiting.h"

namespace ddm {
namespace {

/// While this object exists, standard output is a pipe without a reader.
class StoppedTerminal {
 public:
  StoppedTerminal() {
    std::fflush(stdout);
    EXPECT_EQ(pipe(ends_), 0);
    fcntl(ends_[1], F_SETFL, O_NONBLOCK);
    while (write(ends_[1], "full", 4) > 0) {
    }
    while (write(ends_[1], "!", 1) > 0) {
    }
    fcntl(ends_[1], F_SETFL, 0);
    dup2(ends_[1], STDOUT_FILENO);
  }

  /// Reads the pipe, so that blocked writers can continue.
  ~StoppedTerminal() {
    dup2(stdout_, STDOUT_FILENO);
    close(stdout_);
    close(ends_[1]);
    std::string bytes(1 << 20, ' ');
    while (read(ends_[0], &bytes[0], bytes.size()) > 0) {
    }
    close(ends_[0]);
  }

 private:
  int stdout_ = dup(STDOUT_FILENO);
  int ends_[2] = {-1, -1};
};

TEST(LogThread, WritesAllLinesInTheirOrderBeforeItEnds) {
  testing::internal::CaptureStdout();
  {
    LogThread log;
    for (int i = 0; i < 20; ++i) log.info("line " + std::to_string(i) + ".");
  }
  const std::string text = testing::internal::GetCapturedStdout();
  std::string::size_type at = 0;
  for (int i = 0; i < 20; ++i) {
    at = text.find("line " + std::to_string(i) + ".", at);
    ASSERT_NE(at, std::string::npos) << i << " in " << text;
  }
}

TEST(LogThread, KeepsNobodyWaitingWhereTheTerminalIsStopped) {
  // Destroyed after the terminal continues, so that no thread logs when the process ends.
  LogThread log;
  const StoppedTerminal terminal;
  const auto logged = callWithin(std::chrono::seconds(10), [&log] {
    for (int i = 0; i < 10; ++i) log.info("a line");
    return true;
  });
  EXPECT_TRUE(logged.value_or(false));
}

}  // namespace
}  // namespace ddm
