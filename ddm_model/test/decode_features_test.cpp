// Tests of decode_features as a user calls it: model and features in, pictures and exit code out.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "ddm_files/plain_file.h"
#include "ddm_model/model_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "subprocess.h"
#include "toy_data.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::contains;
using testing::Outcome;

class DecodeFeatures : public ::testing::Test {
 protected:
  DecodeFeatures() { writeFileAtomically(path("toy.ddm"), serialiseModel(model_)); }

  std::string path(const std::string& name) const { return folder_.file(name); }

  /// Runs the tool in the folder of the test on these features.
  Outcome run(const std::string& arguments, const std::string& csv) const {
    std::ofstream(path("features.csv")) << csv;
    return testing::run("( cd " + folder_.file("") + " && " + DDM_MODEL_DECODE_FEATURES + " " +
                        arguments + " < features.csv )");
  }
  void expectRefused(const std::string& csv, const std::vector<std::string>& parts) const {
    const Outcome outcome = run("toy.ddm --frames pictures", csv);
    EXPECT_EQ(outcome.exit_code, 1) << csv;
    EXPECT_TRUE(testing::names(outcome.err, parts)) << csv;
    EXPECT_FALSE(fs::exists(path("pictures"))) << csv;
  }

  const testing::TempFolder folder_;
  const Ddm model_ = testing::toyModel();
};

TEST_F(DecodeFeatures, WritesTheDecodedImageOfEachLine) {
  const Outcome outcome = run("toy.ddm --frames a/b", "z_1,z_2\n0.25,-0.5\n-1e-1, 0.75\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<Eigen::Vector2d> features = {{0.25, -0.5}, {-0.1, 0.75}};
  for (std::size_t k = 0; k < features.size(); ++k) {
    const cv::Mat image =
        cv::imread(path("a/b/frame_000" + std::to_string(k) + ".png"), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_8UC1);
    ASSERT_EQ(image.size(), cv::Size(testing::kToySize, testing::kToySize));
    EXPECT_EQ(Grey(image.datastart, image.dataend), model_.decode(features[k])) << k;
  }
  EXPECT_NE(model_.decode(features[0]), model_.decode(features[1]));
  EXPECT_FALSE(fs::exists(path("a/b/frame_0002.png")));
}

TEST_F(DecodeFeatures, TakesLinesThatEndInCrLfAndBlankLinesAtTheEnd) {
  ASSERT_EQ(run("toy.ddm --frames out", "z_1,z_2\r\n0,0\r\n1,1\r\n\r\n\n").exit_code, 0);
  EXPECT_TRUE(fs::exists(path("out/frame_0001.png")));
  EXPECT_FALSE(fs::exists(path("out/frame_0002.png")));
}

TEST_F(DecodeFeatures, RefusesFeaturesItCannotUseAndNamesTheLine) {
  expectRefused("", {"line 1: ", "header z_1,z_2,", "got \"\""});
  expectRefused("z_1,z_2,z_3\n0,0,0\n", {"line 1: ", "header z_1,z_2,", "got \"z_1,z_2,z_3\""});
  expectRefused("0,0\n", {"line 1: ", "header z_1,z_2,", "got \"0,0\""});
  expectRefused("z_1,z_2\n", {"line 2: ", "no feature"});
  expectRefused("z_1,z_2\n0,0\n0\n", {"line 3: ", " 2 ", "z_1,z_2", "got \"0\""});
  expectRefused("z_1,z_2\n0,0,0\n", {"line 2"});
  expectRefused("z_1,z_2\n0,0\n\n0,0\n", {"line 3"});
  for (const char* word : {"nan", "inf", "1e999", "0x1p0", "1.5m", "--1", ""}) {
    expectRefused(std::string("z_1,z_2\n0,") + word + "\n", {"line 2"});
  }
}

TEST_F(DecodeFeatures, RefusesAFileThatIsNoModelAndNamesIt) {
  std::ofstream(path("text.ddm")) << "no model at all\n";
  for (const char* file : {"text.ddm", "missing.ddm"}) {
    const Outcome outcome = run(std::string(file) + " --frames pictures", "z_1,z_2\n0,0\n");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(contains(outcome.err, file)) << outcome.err;
  }
  EXPECT_FALSE(fs::exists(path("pictures")));
}

TEST_F(DecodeFeatures, NamesAPictureThatCannotBeWritten) {
  fs::create_directories(path("pictures/frame_0000.png"));
  const Outcome outcome = run("toy.ddm --frames pictures", "z_1,z_2\n0,0\n");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(testing::names(outcome.err, {"pictures/frame_0000.png", "written"}));
}

TEST_F(DecodeFeatures, ExplainsItself) {
  const Outcome outcome = run("--help", "");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* part : {"MODEL.ddm", "--frames", "z_1,z_2", "frame_0000.png", "Exit:"}) {
    EXPECT_TRUE(contains(outcome.out, part)) << part;
  }
}

TEST_F(DecodeFeatures, RefusesACommandLineThatMakesNoSense) {
  const auto refused = [this](const std::string& arguments, const std::string& part) {
    const Outcome outcome = run(arguments, "z_1,z_2\n0,0\n");
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_TRUE(contains(outcome.err, part) && contains(outcome.err, "--help")) << outcome.err;
  };
  refused("toy.ddm", "--frames DIR");
  refused("--frames pictures", "model");
  refused("toy.ddm toy.ddm --frames pictures", "too many");
  refused("toy.ddm --frames pictures --nonsense 1", "nonsense");
  EXPECT_FALSE(fs::exists(path("pictures")));
}

}  // namespace
}  // namespace ddm
