// Tests of folder locks: ownership, locks of killed processes, and refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/folder_lock.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/temp_folder.h"

namespace ddm {
namespace {

using testing::throwsNaming;

/// Runs a function in a child process.
pid_t start(const std::function<void()>& function) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  function();
  ::_exit(0);
}

class FolderLockTest : public ::testing::Test {
 protected:
  ::testing::AssertionResult isRefused(const std::vector<std::string>& words) {
    return throwsNaming<std::runtime_error>([this] { FolderLock lock(scratch_.file("")); }, words);
  }

  /// Starts a process that holds the folder until a signal ends it.
  pid_t startOwner() {
    int ready[2];
    if (::pipe(ready) != 0) throw std::runtime_error("no pipe");
    const pid_t owner = start([&] {
      const FolderLock lock(scratch_.file(""));
      if (::write(ready[1], "x", 1) == 1) ::pause();
    });
    char byte = 0;
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
    ::close(ready[1]);
    return owner;
  }

  const testing::TempFolder scratch_;
  const std::string lock_file_ = scratch_.file(".lock");
};

TEST_F(FolderLockTest, AHeldFolderIsRefusedAndAFreeOneHasNoFiles) {
  {
    const FolderLock lock(scratch_.file(""));
    EXPECT_TRUE(isRefused(
        {scratch_.file(""), "process " + std::to_string(::getpid()) + " on ", "another folder"}));
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.file("")));
  EXPECT_NO_THROW(FolderLock lock(scratch_.file("")));
}

TEST_F(FolderLockTest, TheLockOfAKilledProcessIsReplaced) {
  const pid_t owner = startOwner();
  EXPECT_TRUE(isRefused({"process " + std::to_string(owner)}));
  ::kill(owner, SIGKILL);
  siginfo_t info;
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(owner), &info, WEXITED | WNOWAIT), 0);
  EXPECT_NO_THROW(FolderLock lock(scratch_.file("")));  // although the process is a zombie
  ::waitpid(owner, nullptr, 0);
}

TEST_F(FolderLockTest, ASignalDeletesTheLockAndEndsTheProcess) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t owner = startOwner();
    ::kill(owner, number);
    int status = 0;
    ::waitpid(owner, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number);
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.file("")));
  }
}

TEST_F(FolderLockTest, OnlyTheLockOfAProcessThatHasCertainlyEndedIsReplaced) {
  char host[256] = "";
  ::gethostname(host, sizeof(host) - 1);
  std::ofstream(lock_file_) << host << " 1\n";  // a process with this number is running
  EXPECT_NO_THROW(FolderLock lock(scratch_.file("")));
  std::ofstream(lock_file_) << "node17 1\n";
  EXPECT_TRUE(isRefused({"process 1 on node17", "delete " + lock_file_, "sure"}));
  EXPECT_TRUE(std::filesystem::exists(lock_file_));
  EXPECT_FALSE(std::filesystem::exists(lock_file_ + ".new"));
}

TEST_F(FolderLockTest, ALockWithoutAProcessIsRefusedWithTheFileToDelete) {
  for (const std::string text : {"", "garbage", "node17"}) {
    std::ofstream(lock_file_) << text;
    EXPECT_TRUE(isRefused({"delete " + lock_file_}));
  }
}

TEST_F(FolderLockTest, OfManyProcessesOneAtATimeHasTheFolder) {
  constexpr int kProcesses = 8;
  std::vector<pid_t> all;
  for (int i = 0; i < kProcesses; ++i) {
    all.push_back(start([&] {
      for (int k = 0; k < 40; ++k) {
        std::unique_ptr<FolderLock> lock;
        try {
          lock = std::make_unique<FolderLock>(scratch_.file(""));
        } catch (const std::runtime_error&) {
          continue;
        }
        const std::string alone = scratch_.file("alone");
        if (::open(alone.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0666) < 0) ::_exit(1);
        ::usleep(200);
        ::unlink(alone.c_str());
        if (k % 10 == 9) ::raise(SIGKILL);  // leaves a lock behind
      }
    }));
  }
  for (const pid_t one : all) {
    int status = 0;
    ::waitpid(one, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
  }
  EXPECT_NO_THROW(FolderLock lock(scratch_.file("")));
}

}  // namespace
}  // namespace ddm
