// Tests of BagAccess: no request names a bag outside of what the operator has given.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_access.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/temp_folder.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::throwsNaming;

class BagAccessTest : public ::testing::Test {
 protected:
  BagAccessTest() {
    for (const std::string& folder : {run_, run_ + "/trial_000", run_ + "2", outside_}) {
      fs::create_directory(folder);
    }
    std::ofstream(outside_ + "/own.bag") << "a bag";
    access_.bags = {run_, outside_ + "/own.bag"};
  }

  ::testing::AssertionResult refuses(const std::string& path) const {
    return throwsNaming<std::runtime_error>([&] { access_.require(path); },
                                            {path, run_, "access/bags"});
  }

  const ddm::testing::TempFolder folder_;
  const std::string run_ = folder_.file("run");
  const std::string outside_ = folder_.file("outside");
  BagAccess access_;
};

TEST_F(BagAccessTest, TakesBagsInTheFolderWhetherTheyExistOrNot) {
  EXPECT_NO_THROW(access_.require(run_ + "/trial_000/trial.bag"));
  EXPECT_NO_THROW(access_.require(run_ + "/trial_001/trial.bag"));
  EXPECT_NO_THROW(access_.require(run_ + "/trial_000/../trial_001/trial.bag"));
  access_.bags = {run_ + "/"};
  EXPECT_NO_THROW(access_.require(run_ + "/trial.bag"));
}

TEST_F(BagAccessTest, TakesASingleBagAndNotItsNeighbour) {
  EXPECT_NO_THROW(access_.require(outside_ + "/own.bag"));
  EXPECT_TRUE(refuses(outside_ + "/other.bag"));
}

TEST_F(BagAccessTest, RefusesWhatIsNoPath) {
  for (const std::string& path : {std::string(), run_ + std::string("/a\0.bag", 7)}) {
    EXPECT_TRUE(
        throwsNaming<std::runtime_error>([&] { access_.require(path); }, {"is not a path"}));
  }
}

TEST_F(BagAccessTest, ARecordingIsANewBag) {
  EXPECT_NO_THROW(access_.requireNew(run_ + "/trial_000/trial.bag"));
  for (const std::string name : {"/trials.csv", "/", "/trial_000/trial", "/.bag"}) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { access_.requireNew(run_ + name); },
                                                 {run_ + name, "end in .bag"}));
  }
  std::ofstream(run_ + "/trial_000/trial.bag") << "a bag";
  fs::create_symlink(run_ + "/nowhere", run_ + "/link.bag");
  for (const std::string name : {"/trial_000/trial.bag", "/link.bag"}) {
    EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { access_.requireNew(run_ + name); },
                                                 {run_ + name, "exists already"}));
  }
  EXPECT_THROW(access_.requireNew(outside_ + "/new.bag"), std::runtime_error);
}

TEST_F(BagAccessTest, RefusesAbsolutePathsElsewhere) {
  EXPECT_TRUE(refuses("/etc/passwd"));
  EXPECT_TRUE(refuses("/dev/zero"));
  EXPECT_TRUE(refuses(run_ + "2/trial.bag"));  // begins with the same letters
}

TEST_F(BagAccessTest, RefusesToClimbOutOfTheFolder) {
  EXPECT_TRUE(refuses(run_ + "/../outside/trial.bag"));
  EXPECT_TRUE(refuses(run_ + "/missing/../../outside/trial.bag"));
  EXPECT_TRUE(refuses("../outside/trial.bag"));
}

TEST_F(BagAccessTest, RefusesLinksThatLeaveTheFolder) {
  fs::create_directory_symlink(outside_, run_ + "/folder");
  EXPECT_TRUE(refuses(run_ + "/folder/trial.bag"));
  fs::create_symlink(outside_ + "/other.bag",
                     run_ + "/missing.bag");  // writing there would make it
  EXPECT_TRUE(refuses(run_ + "/missing.bag"));
  fs::create_symlink("missing.bag", run_ + "/twice.bag");
  EXPECT_TRUE(refuses(run_ + "/twice.bag"));
}

TEST_F(BagAccessTest, FollowsLinksThatStayInTheFolderOrLeadToIt) {
  fs::create_symlink("trial_000/trial.bag", run_ + "/newest.bag");
  EXPECT_NO_THROW(access_.require(run_ + "/newest.bag"));
  fs::create_directory_symlink(run_, folder_.file("link"));
  EXPECT_NO_THROW(access_.require(folder_.file("link/trial.bag")));
  access_.bags = {folder_.file("link")};
  EXPECT_NO_THROW(access_.require(run_ + "/trial.bag"));
}

TEST_F(BagAccessTest, RefusesALinkToItself) {
  fs::create_symlink("loop.bag", run_ + "/loop.bag");
  EXPECT_TRUE(
      throwsNaming<std::runtime_error>([&] { access_.require(run_ + "/loop.bag"); }, {"links"}));
}

TEST_F(BagAccessTest, TakesByDefaultWhatLiesWhereTheNodeWasStarted) {
  EXPECT_NO_THROW(BagAccess().require("trial.bag"));
  EXPECT_THROW(BagAccess().require("../trial.bag"), std::runtime_error);
  EXPECT_THROW(BagAccess().require(run_ + "/trial.bag"), std::runtime_error);
}

TEST_F(BagAccessTest, WithoutFoldersRefusesEverything) {
  access_.bags = {};
  EXPECT_TRUE(throwsNaming<std::runtime_error>([&] { access_.require("trial.bag"); },
                                               {"trial.bag", "no folder"}));
  EXPECT_TRUE(access_.problems().empty());
  access_.bags = {run_, ""};
  EXPECT_EQ(access_.problems().size(), 1U);
}

}  // namespace
}  // namespace ddm
