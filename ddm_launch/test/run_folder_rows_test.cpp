// The rows of a run folder: none is lost, changed or taken from elsewhere, and those of older versions are read.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/model_file.h>
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
using testing::withoutVersions;
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

/// @param rows  texts of trials.csv with 1, 2, ... rows
std::string checksumsOf(const std::vector<std::string>& rows) {
  std::string lines;
  for (const std::string& text : rows) lines += checksum(text) + "\n";
  return lines;
}

TEST_F(RunFolderRowsTest, ATableOfAnOlderVersionGoesOnInTodaysColumns) {
  for (const auto& older : {testing::inDegrees, withoutVersions}) {
    fs::remove_all(scratch_.file("run"));
    finish(2);
    const std::vector<std::string> old = {older(formatTrialsCsv({toyRow(0)})),
                                          older(textOf(file("trials.csv")))};
    writeText(file("trials.csv"), old[1]);
    writeText(file(".trials.crc32"), checksumsOf(old));
    const std::string version = older == withoutVersions ? "?" : toyRow(1).version;
    {
      RunFolder folder(configuration_);
      ASSERT_EQ(folder.rows().size(), 2u);
      EXPECT_EQ(folder.rows()[1].version, version);
      EXPECT_EQ(folder.rows()[1].evaluation.final_error, toyRow(1).evaluation.final_error);
      EXPECT_TRUE(folder.warnings().empty());
      writeText(folder.beginRun({2}), "a bag");
      folder.finishTrial(toyRow(2));
    }
    const RunFolder folder(configuration_);
    EXPECT_EQ(folder.rows()[0].version, version);
    EXPECT_EQ(folder.rows()[2].version, toyRow(2).version);
  }
}

/// config.yaml as versions saved it whose cameras drew the rod and whose errors were angles.
YAML::Node asSavedBefore(const YAML::Node& today) {
  YAML::Node old = YAML::Clone(today);
  old["camera"]["size"] = old["plant"]["picture_size"];
  old["plant"].remove("picture_size");
  for (const char* key : {"half_extent", "rod_half_width", "edge_softness"}) {
    old["camera"][key] = old["plant"][key];
    old["plant"].remove(key);
  }
  old["plant"]["tile_width"] = 9.0;
  old["plant"]["tile_softness"] = 9.0;
  old["evaluation"]["tolerance_deg"] = old["evaluation"]["tolerance"];
  old["evaluation"].remove("tolerance");
  old["evaluation"].remove("error_unit");
  old["training"]["ensemble_size"] = "1";
  old["mpc"]["terminal_weight"] = "1.0";
  return old;
}

TEST_F(RunFolderRowsTest, AFolderOfAnOlderVersionIsTakenUp) {
  finish(2);
  const YAML::Node today = YAML::LoadFile(file("config.yaml"));
  const YAML::Node old = asSavedBefore(today);
  writeText(file("config.yaml"), YAML::Dump(old) + "\n");
  EXPECT_EQ(RunFolder(configuration_).rows().size(), 2u);
  configuration_.camera.noise_std = 0.3;
  expectRefused({"camera/noise_std"});
}

TEST_F(RunFolderRowsTest, AFolderOfAnOlderVersionThatEndedBetweenTheChecksumAndItsRowIsTakenUp) {
  finish(2);
  writeText(file("trials.csv"), withoutVersions(textOf(file("trials.csv"))));
  TrialRow rows[] = {toyRow(0), toyRow(1), toyRow(2)};
  for (int i : {0, 1}) rows[i].version = "?";
  writeText(file(".trials.crc32"), formatTrialsChecksums({rows[0], rows[1], rows[2]}));
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
