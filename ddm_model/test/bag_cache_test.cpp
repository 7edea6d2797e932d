// Tests of the bag cache: bags are read once, and trials never joined.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_cache.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "toy_bags.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::toyTrial;

class BagCacheTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const DataSet& trial) const {
    testing::writeTrial(folder_.file(name), trial);
    return folder_.file(name);
  }
  ::testing::AssertionResult isRefused(const std::vector<std::string>& bags,
                                       const std::vector<std::string>& words) {
    return testing::throwsNaming<std::runtime_error>([&] { cache_.read(bags); }, words);
  }

  const testing::TempFolder folder_;
  BagCache cache_{testing::kToySize, BagOptions()};
};

TEST_F(BagCacheTest, KeepsTrialsApartAndInOrder) {
  const DataSet data =
      cache_.read({write("b.bag", toyTrial(7, 1)), write("a.bag", toyTrial(5, 2))});
  ASSERT_EQ(data.segments().size(), 2U);
  EXPECT_EQ(data.segments()[0].size, 7);
  EXPECT_EQ(data.segments()[1].begin, 7);
  EXPECT_EQ(data.segments()[1].size, 5);
  EXPECT_EQ(data.torques()(0, 7), toyTrial(5, 2).torques()(0, 0));
  EXPECT_TRUE(data.hasGoal());
}

TEST_F(BagCacheTest, ReadsABagOnlyOnceAndAgainWhenTheFileChanges) {
  const std::string path = write("a.bag", toyTrial(7, 1));
  const fs::file_time_type time = fs::last_write_time(path);
  const auto size = fs::file_size(path);
  EXPECT_EQ(cache_.read({path}).numFrames(), 7);
  std::ofstream(path, std::ios::trunc) << std::string(size, 'x');  // cannot be read any more
  fs::last_write_time(path, time);
  EXPECT_EQ(cache_.read({path}).numFrames(), 7);
  fs::last_write_time(path, time + std::chrono::milliseconds(1));
  EXPECT_THROW(cache_.read({path}), std::runtime_error);
  write("a.bag", toyTrial(9, 1));
  EXPECT_EQ(cache_.read({path}).numFrames(), 9);
}

TEST_F(BagCacheTest, RefusesAFileThatIsGivenByTwoPaths) {
  const std::string a = write("a.bag", toyTrial(7, 1));
  fs::create_symlink(a, folder_.file("link.bag"));
  fs::create_hard_link(a, folder_.file("hard.bag"));
  for (const std::string& other :
       {folder_.file("./a.bag"), folder_.file("link.bag"), folder_.file("hard.bag")}) {
    EXPECT_TRUE(isRefused({a, other}, {a, other, "twice"}));
  }
}

TEST_F(BagCacheTest, ForgetsABagThatIsNoLongerAskedFor) {
  const std::string a = write("a.bag", toyTrial(7, 1)), b = write("b.bag", toyTrial(5, 2));
  const fs::file_time_type time = fs::last_write_time(a);
  cache_.read({a, b});
  const auto size = fs::file_size(a);
  std::ofstream(a, std::ios::trunc) << std::string(size, 'x');
  fs::last_write_time(a, time);
  cache_.read({b});
  EXPECT_THROW(cache_.read({a, b}), std::runtime_error) << "it must be read anew";
}

TEST_F(BagCacheTest, StopsBeforeTheNextBagWhenItIsTold) {
  const std::string a = write("a.bag", toyTrial(7, 1)), missing = folder_.file("b.bag");
  EXPECT_THROW(cache_.read({a, missing}, [] { return false; }), ReadingCancelled);
}

TEST_F(BagCacheTest, TellsTheNotesOfEachBagOnce) {
  std::vector<std::string> notes;
  BagCache cache(testing::kToySize, BagOptions(),
                 [&notes](const std::string& note) { notes.push_back(note); });
  DataSet dark(testing::kToySize, 1);
  for (int t = 0; t < 5; ++t) dark.append(Image(64, 3), Eigen::VectorXd::Zero(1), t == 0);
  const std::string path = write("dark.bag", dark);
  cache.read({path});
  cache.read({path});
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_TRUE(testing::names(notes[0], {path, "grey values"}));
}

TEST_F(BagCacheTest, RefusesToMixCameras) {
  const std::string small = write("small.bag", toyTrial(5, 1));
  const std::string large = write("large.bag", toyTrial(5, 1, 16));
  EXPECT_TRUE(isRefused({small, large}, {small, large, "8x8 mono8", "16x16 mono8"}));
  BagOptions others;
  others.dt = 0.2;  // as for bags that others recorded, whose cameras may differ
  EXPECT_EQ(BagCache(testing::kToySize, others).read({small, large}).numFrames(), 10);
}

TEST_F(BagCacheTest, RefusesToMixNumbersOfMotors) {
  const std::string one = write("one.bag", toyTrial(5, 1)), two = folder_.file("two.bag");
  {
    testing::ToyBag bag(two);
    bag.image(1.0, 0.0);
    bag.torque(1.0, {1.0, 2.0});
  }
  EXPECT_TRUE(isRefused({one, two}, {one, two, "1 torque", "2 torque"}));
}

TEST_F(BagCacheTest, NamesTheBagThatIsMissingAndRefusesAnEmptyList) {
  const std::string path = write("a.bag", toyTrial(5, 1)), missing = folder_.file("b.bag");
  EXPECT_TRUE(isRefused({path, missing}, {missing, "No such file"}));
  EXPECT_TRUE(isRefused({}, {"no bag"}));
}

}  // namespace
}  // namespace ddm
