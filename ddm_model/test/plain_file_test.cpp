// Tests of whole files: what is written is read, faults are named, and what was there stays.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/plain_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "ddm_model/testing/expect_error.h"
#include "ddm_model/testing/temp_folder.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

class PlainFile : public ::testing::Test {
 protected:
  ::testing::AssertionResult isNotRead(const std::string& path, const std::string& why) const {
    return testing::throwsNaming<std::runtime_error>([&] { readFile(path); }, {path, why});
  }
  ::testing::AssertionResult isNotWritten(const std::string& path, const std::string& why) const {
    return testing::throwsNaming<std::runtime_error>([&] { writeFileAtomically(path, "new"); },
                                                     {path, why});
  }

  const testing::TempFolder folder_;
  const std::string path_ = folder_.file("a.model");
};

TEST_F(PlainFile, IsWrittenAndReadAgain) {
  const std::string bytes("all\0bytes\n\xff", 11);
  writeFileAtomically(path_, "an older and much longer text");
  writeFileAtomically(path_, bytes);
  EXPECT_EQ(readFile(path_), bytes);
  EXPECT_FALSE(fs::exists(path_ + ".unfinished"));
  writeFileAtomically(path_, "");
  EXPECT_EQ(readFile(path_), "");
}

TEST_F(PlainFile, AWriteThatFailsLeavesTheOldFile) {
  writeFileAtomically(path_, "old");
  fs::create_directory(path_ + ".unfinished");  // in the way, even for root
  EXPECT_TRUE(isNotWritten(path_, "File exists"));
  EXPECT_EQ(readFile(path_), "old");
  EXPECT_TRUE(isNotWritten(folder_.file("missing/a"), "No such file"));
}

TEST_F(PlainFile, ALinkInTheWayIsNotFollowed) {
  writeFileAtomically(folder_.file("other"), "of somebody else");
  fs::create_symlink(folder_.file("other"), path_ + ".unfinished");
  writeFileAtomically(path_, "new");
  EXPECT_EQ(readFile(folder_.file("other")), "of somebody else");
  EXPECT_EQ(readFile(path_), "new");
}

TEST_F(PlainFile, WhatIsNoPlainFileIsNeitherReplacedNorWaitedFor) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_TRUE(isNotRead(path_, "it is no plain file"));
  EXPECT_TRUE(isNotWritten(path_, "it is no plain file"));
  EXPECT_TRUE(fs::is_fifo(path_));
  EXPECT_TRUE(isNotRead("/dev/zero", "it is no plain file"));
  EXPECT_TRUE(isNotWritten("/proc/self", "it is no plain file"));
}

TEST_F(PlainFile, AFileThatCannotBeReadIsNamed) {
  EXPECT_TRUE(isNotRead(path_, "No such file"));
  EXPECT_TRUE(isNotRead(folder_.file(""), "Is a directory"));
}

}  // namespace
}  // namespace ddm
