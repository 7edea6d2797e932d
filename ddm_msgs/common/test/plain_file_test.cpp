// Tests of reading and writing whole files: content, error messages, no change after errors.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/plain_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/file_size_limit.h"
#include "ddm_msgs/testing/temp_folder.h"

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

  /// Names of all entries of the folder.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.file(""))) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }

  const testing::TempFolder folder_;
  const std::string path_ = folder_.file("a.model");
};

TEST_F(PlainFile, IsWrittenAndReadAgain) {
  const std::string bytes("all\0bytes\n\xff", 11);
  writeFileAtomically(path_, "an older and much longer text");
  writeFileAtomically(path_, bytes);
  EXPECT_EQ(readFile(path_), bytes);
  EXPECT_EQ(files(), std::vector<std::string>{"a.model"});
  writeFileAtomically(path_, "");
  EXPECT_EQ(readFile(path_), "");
}

TEST_F(PlainFile, AWriteThatFailsLeavesTheOldFileAndNothingElse) {
  writeFileAtomically(path_, "old");
  {
    const testing::FileSizeLimit limit(1);  // less than the three bytes to write
    EXPECT_TRUE(isNotWritten(path_, "File too large"));
  }
  EXPECT_EQ(readFile(path_), "old");
  EXPECT_EQ(files(), std::vector<std::string>{"a.model"});
  EXPECT_TRUE(isNotWritten(folder_.file("missing/a"), "No such file"));
}

TEST_F(PlainFile, AFileOfAnotherWriterGetsItsFinalNameOrIsNamedAndStays) {
  const std::string active = path_ + ".active";
  writeFileAtomically(path_, "old");
  writeFileAtomically(active, "new");
  renameDurably(active, path_);
  EXPECT_EQ(readFile(path_), "new");
  EXPECT_EQ(files(), std::vector<std::string>{"a.model"});
  EXPECT_TRUE(testing::throwsNaming<std::runtime_error>([&] { renameDurably(active, path_); },
                                                        {active, "No such file"}));
  EXPECT_TRUE(testing::throwsNaming<std::runtime_error>(
      [&] { renameDurably(path_, folder_.file("")); }, {path_, folder_.file("")}));
  EXPECT_TRUE(testing::throwsNaming<std::runtime_error>(
      [&] { renameDurably(path_, folder_.file("missing/a")); }, {path_, "No such file"}));
  EXPECT_EQ(readFile(path_), "new");
}

TEST_F(PlainFile, AFileOfTheCurrentFolderNeedsNoFolderInItsPath) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.file(""));
  EXPECT_NO_THROW(writeFileAtomically("a.active", "new"));
  EXPECT_NO_THROW(renameDurably("a.active", "a.model"));
  fs::current_path(before);
  EXPECT_EQ(readFile(path_), "new");
}

TEST_F(PlainFile, WhatKilledWritersLeftBehindIsRemovedOnRequest) {
  std::filesystem::create_directory(folder_.file("trial_000"));
  const std::vector<std::string> others = {"file.unfinished.txt", "unfinished.0f",
                                           "trial_000/a.csv"};
  const std::vector<std::string> left = {"file.unfinished.0f12",
                                         "trial_000/model.ddm.unfinished.9"};
  for (const auto& names : {others, left}) {
    for (const std::string& name : names) std::ofstream(folder_.file(name)) << "half";
  }
  removeUnfinished(folder_.file(""));
  for (const std::string& name : others) EXPECT_TRUE(std::filesystem::exists(folder_.file(name)));
  for (const std::string& name : left) EXPECT_FALSE(std::filesystem::exists(folder_.file(name)));
}

TEST_F(PlainFile, PermissionsFollowTheUmask) {
  const mode_t before = ::umask(0027);
  writeFileAtomically(path_, "new");
  ::umask(before);
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms(0640));
}

TEST_F(PlainFile, OfWritersAtTheSameTimeEachReaderSeesOneWhole) {
  constexpr int kWrites = 200;
  const std::vector<std::string> contents = {std::string(300000, 'a'), std::string(500000, 'b')};
  writeFileAtomically(path_, contents[0]);
  std::atomic<int> num_writing{2};
  std::vector<std::string> errors(contents.size());
  std::vector<std::thread> writers;
  for (size_t i = 0; i < contents.size(); ++i) {
    writers.emplace_back([&, i] {
      try {
        for (int k = 0; k < kWrites; ++k) writeFileAtomically(path_, contents[i]);
      } catch (const std::exception& e) {
        errors[i] = e.what();
      }
      --num_writing;
    });
  }
  int num_torn = 0;
  do {
    const std::string seen = readFile(path_);
    if (seen != contents[0] && seen != contents[1]) ++num_torn;
  } while (num_writing > 0);
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(num_torn, 0);
  EXPECT_EQ(errors, std::vector<std::string>(2));
  EXPECT_EQ(files(), std::vector<std::string>{"a.model"});
}

TEST_F(PlainFile, WhatIsNotARegularFileIsNeitherReplacedNorWaitedFor) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  EXPECT_TRUE(isNotRead(path_, "regular file"));
  EXPECT_TRUE(isNotWritten(path_, "regular file"));
  EXPECT_TRUE(fs::is_fifo(path_));
  EXPECT_TRUE(isNotRead("/dev/zero", "regular file"));
  EXPECT_TRUE(isNotWritten("/proc/self", "regular file"));
}

TEST_F(PlainFile, WhetherItCanBeWrittenIsTriedWithoutAChange) {
  const auto isRefused = [](const std::string& path, const std::string& why) {
    return testing::throwsNaming<std::runtime_error>([&] { requireWritable(path); }, {path, why});
  };
  EXPECT_NO_THROW(requireWritable(path_));
  EXPECT_EQ(files(), std::vector<std::string>{});
  writeFileAtomically(path_, "old");
  EXPECT_NO_THROW(requireWritable(path_));
  EXPECT_EQ(readFile(path_), "old");
  EXPECT_EQ(files(), std::vector<std::string>{"a.model"});
  EXPECT_TRUE(isRefused(folder_.file("missing/a"), "No such file"));
  EXPECT_TRUE(isRefused(folder_.file(""), "regular file"));
}

TEST_F(PlainFile, AFileThatCannotBeReadIsNamed) {
  EXPECT_TRUE(isNotRead(path_, "No such file"));
  EXPECT_TRUE(isNotRead(folder_.file(""), "Is a directory"));
}

}  // namespace
}  // namespace ddm
