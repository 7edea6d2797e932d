// The rows of a run folder: none is lost, changed or taken from elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <boost/filesystem.hpp>
#include <string>
#include <vector>

#include "run_folder.h"
#include "run_folder_case.h"
#include "toy_run.h"
#include "trials_csv.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::textOf;
using testing::toyRow;
using testing::writeText;

using RunFolderRowsTest = testing::RunFolderCase;

TEST_F(RunFolderRowsTest, RowsThatAreNotThoseOfTheExperimentAreRefused) {
  finish(2);
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0), toyRow(2)}));
  expectRefused({"trials.csv", "row 2", "trial 1"});
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0, /*seed=*/9)}));
  expectRefused({"trials.csv", "row 1", "seed 7"});
  writeText(file("trials.csv"), "nonsense\n");
  expectRefused({"trials.csv", "line 1"});
}

TEST_F(RunFolderRowsTest, RowsOfWhichAnyByteHasChangedAreRefused) {
  finish(2);
  const std::string rows = textOf(file("trials.csv"));
  for (size_t at = 0; at < rows.size(); ++at) {
    std::string changed = rows;
    changed[at] = static_cast<char>(changed[at] ^ 1);  // another digit, where there is one
    writeText(file("trials.csv"), changed);
    expectRefused({"trials.csv"});
  }
  writeText(file("trials.csv"), rows);
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
}

TEST_F(RunFolderRowsTest, AnExperimentThatEndedBetweenTheChecksumAndItsRowIsTakenUp) {
  finish(2);
  writeText(file("trials.csv"), formatTrialsCsv({toyRow(0)}));
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 1u);
}

TEST_F(RunFolderRowsTest, RowsThatTheChecksumsDoNotKnowAreRefused) {
  finish(2);
  writeText(file(".trials.crc32"), "");
  expectRefused({"trials.csv", ".trials.crc32", "remove"});
}

TEST_F(RunFolderRowsTest, RowsWithoutChecksumsAreTakenWithAWarning) {
  finish(2);
  fs::remove(file(".trials.crc32"));
  {
    RunFolder folder(configuration_);
    ASSERT_EQ(folder.warnings().size(), 1u);
    EXPECT_NE(folder.warnings()[0].find(".trials.crc32"), std::string::npos);
    writeText(folder.beginRun({2}), "a bag");
    folder.finishTrial(toyRow(2));
  }
  EXPECT_TRUE(RunFolder(configuration_).warnings().empty());
}

TEST_F(RunFolderRowsTest, RowsWithoutAConfigurationAreRefused) {
  finish(1);
  fs::remove(file("config.yaml"));
  expectRefused({"trials.csv", "no config.yaml"});
}

}  // namespace
}  // namespace ddm
