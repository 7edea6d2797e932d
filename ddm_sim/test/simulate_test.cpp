// Tests of the program simulate from the command line: input files, output files and exit codes.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ddm_common/plain_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/run_program.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

using testing::contains;
using testing::Outcome;

/// Rows of the trajectory: step, time, components of the state. Checks header and columns.
std::vector<std::vector<double>> rows(
    const std::string& csv, const std::string& header = "step,time_s,angle_rad,rate_rad_per_s",
    std::size_t num_columns = 4) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, header);
  std::vector<std::vector<double>> out;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    EXPECT_EQ(row.size(), num_columns) << line;
    out.push_back(row);
  }
  return out;
}

const char kTileHeader[] = "step,time_s,x_px,y_px";

class Simulate : public ::testing::Test {
 protected:
  // Finds the package in the source folder, so that the test needs no sourced workspace.
  void SetUp() override { setenv("ROS_PACKAGE_PATH", DDM_SIM_SOURCE_DIR, /*overwrite=*/1); }

  /// @param setting  shell words in front of the command: assignments, or `unset ...;`
  static Outcome run(const std::string& options, const std::string& input,
                     const std::string& setting = "") {
    return testing::run(setting + " " DDM_SIM_SIMULATE " " + options, input);
  }

  /// Expects that the program ends with this exit code, names all words and writes no trajectory.
  static void expectRefused(int exit_code, const std::string& options,
                            const std::vector<std::string>& words,
                            const std::string& input = "torque_nm\n1\n") {
    const Outcome outcome = run(options, input);
    EXPECT_EQ(outcome.exit_code, exit_code) << options;
    EXPECT_TRUE(testing::names(outcome.err, words)) << options;
    EXPECT_EQ(outcome.out, "") << options;
  }

  const testing::TempFolder temp_;
  const fs::path folder_ = temp_.file("");
};

TEST_F(Simulate, WritesTheTrajectoryOfThePlant) {
  const Outcome result = run("--plant pendulum --start 0.25,-3", "torque_nm\n1\n-2.5\n6\n0\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto table = rows(result.out);
  ASSERT_EQ(table.size(), 5U);
  Pendulum plant{PendulumOptions()};
  plant.setState(Eigen::Vector2d(0.25, -3.0));
  const std::vector<double> torques{1.0, -2.5, 6.0, 0.0};
  for (std::size_t t = 0; t < table.size(); ++t) {
    if (t > 0) plant.step(Eigen::VectorXd::Constant(1, torques[t - 1]));
    EXPECT_EQ(table[t][0], t);
    EXPECT_NEAR(table[t][1], 0.2 * t, 1e-15);
    EXPECT_EQ(table[t][2], plant.state()[0]);  // 17 digits give the same double
    EXPECT_EQ(table[t][3], plant.state()[1]);
  }
}

TEST_F(Simulate, WritesTheTrajectoryAndTheImagesOfTheMovingTile) {
  const fs::path frames = folder_ / "frames";
  const Outcome result = run("--plant moving_tile --start 44.25,6 --frames " + frames.string(),
                             // reflection, saturation, reflection
                             "dx_px,dy_px\n4,-0.5\n-100,2\n0,-5\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto table = rows(result.out, kTileHeader);
  const std::vector<std::vector<double>> expected{
      {0, 0, 44.25, 6}, {1, 0.2, 44.75, 5.5}, {2, 0.4, 39.75, 7.5}, {3, 0.2 * 3, 39.75, 6.5}};
  EXPECT_EQ(table, expected);
  const MovingTile plant{MovingTileOptions()};
  for (int t = 0; t < 4; ++t) {
    const fs::path path = frames / ("frame_000" + std::to_string(t) + ".png");
    const cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_8UC1) << path;
    const std::vector<std::uint8_t> grey(image.begin<std::uint8_t>(), image.end<std::uint8_t>());
    EXPECT_EQ(grey, plant.render(Eigen::Vector2d(table.at(t)[2], table.at(t)[3])).bytes) << path;
  }
}

TEST_F(Simulate, DescribesThePlant) {
  const Outcome result = run("--plant two_link --describe", "");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const YAML::Node about = YAML::Load(result.out);
  EXPECT_EQ(about["joints"][1]["name"].as<std::string>(), "elbow");
  EXPECT_EQ(about["joints"][1]["kind"].as<std::string>(), "angle");
  EXPECT_EQ(about["torque"].as<std::vector<std::string>>(),
            (std::vector<std::string>{"shoulder_nm", "elbow_nm"}));
  EXPECT_EQ(about["max_torque"].as<std::vector<double>>(), (std::vector<double>{4.0, 2.0}));
  EXPECT_EQ(about["start"].as<std::vector<double>>(), std::vector<double>(4, 0.0));
  EXPECT_NEAR(about["goal"][0].as<double>(), 3.14159265, 1e-8);
  EXPECT_EQ(about["error_unit"].as<std::string>(), "deg");
  EXPECT_EQ(about["tolerance"].as<double>(), 10.0);
  EXPECT_EQ(about["dt"].as<double>(), 0.2);
}

class SimulateModelFile : public Simulate {
 protected:
  void SetUp() override {
    if (!DDM_HAS_MUJOCO) GTEST_SKIP() << "ddm_sim was built without MuJoCo";
    Simulate::SetUp();
  }
};

TEST_F(SimulateModelFile, RewardsTheReacherAtItsTarget) {
  const std::string torques = "shoulder_nm,wrist_nm\n0,0\n";
  const char* const header =
      "step,time_s,shoulder_rad,wrist_rad,shoulder_rad_per_s,wrist_rad_per_s,reward";
  const auto rewardAt = [&](const std::string& target) {
    const Outcome result =
        run("--plant suite_reacher_hard --start 0.5,0,0,0 --target " + target, torques);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return rows(result.out, header, 7).at(1).at(6);
  };
  EXPECT_EQ(rewardAt("0.1907,0.1080"), 1.0);  // 20 mm inwards along the straight arm
  EXPECT_EQ(rewardAt("0.1843,0.1007"), 0.0);  // 30 mm
  EXPECT_EQ(run("--plant suite_reacher --target 0.3,0.1", torques).exit_code, 2);
  EXPECT_EQ(run("--plant suite_reacher --target 0.1", torques).exit_code, 2);
  EXPECT_EQ(run("--plant suite_reacher --target 0.1,nan", torques).exit_code, 2);
  EXPECT_EQ(run("--plant suite_pendulum --target 0.1,0.1", "torque_nm\n0\n").exit_code, 2);
}

TEST_F(SimulateModelFile, WritesTheSameBytesInEachProcessAndNeedsNoScreen) {
  const std::string torques = "shoulder_nm,wrist_nm\n0.05,-0.02\n0,0.05\n-0.05,0.01\n";
  const std::string options = "--plant suite_reacher --start 0.1,2.7,0,3 --frames ";
  const Outcome first = run(options + (folder_ / "first").string(), torques);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  for (const char* setting : {"LP_NUM_THREADS=1", "LP_NUM_THREADS=3", "DISPLAY=:99",
                              "unset DISPLAY WAYLAND_DISPLAY XDG_RUNTIME_DIR;"}) {
    EXPECT_EQ(run(options + (folder_ / "again").string(), torques, setting).out, first.out);
    for (const char* image : {"frame_0000.png", "frame_0003.png"}) {
      const std::string bytes = readFile((folder_ / "first" / image).string());
      EXPECT_FALSE(bytes.empty());
      EXPECT_EQ(readFile((folder_ / "again" / image).string()), bytes) << setting;
    }
  }
}

TEST_F(SimulateModelFile, NamesTheStepOfEglThatFails) {
  const std::pair<const char*, const char*> cases[] = {
      {"__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null", "eglGetPlatformDisplayEXT"},
      {"LIBGL_DRIVERS_PATH=/nowhere GALLIUM_DRIVER=nothing", "eglInitialize"}};
  for (const auto& [setting, step] : cases) {
    const Outcome outcome = run("--plant suite_pendulum --frames " + (folder_ / "none").string(),
                                "torque_nm\n", setting);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(testing::names(outcome.err, {step, "libgl1-mesa-dri"}));
  }
}

TEST_F(SimulateModelFile, DescribesAModelFile) {
  const Outcome result = run("--plant suite_cartpole --describe", "");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const YAML::Node about = YAML::Load(result.out);
  EXPECT_EQ(about["torque"][0].as<std::string>(), "force_n");
  EXPECT_EQ(about["joints"][0]["kind"].as<std::string>(), "length");
  EXPECT_EQ(about["evaluation_steps"].as<int>(), 200);
  EXPECT_TRUE(contains(about["renderer"].as<std::string>(), "llvmpipe"));  // the software renderer
}

#if !DDM_HAS_MUJOCO
TEST_F(Simulate, SaysWhatIsMissingForAModelFile) {
  expectRefused(1, "--plant suite_pendulum", {"libmujoco-dev"});
}
#endif

TEST_F(Simulate, RefusesAWrongCommandLineAndNamesTheWordAndTheRemedy) {
  for (const char* plant : {"cart", "sim", "../config/pendulum", "''"}) {
    expectRefused(2, std::string("--plant ") + plant,
                  {"moving_tile, ", "pendulum, pendulum_gravity, ", "two_link"});
  }
  expectRefused(2, "", {"--plant"});
  expectRefused(2, "--plant pendulum --strat 3", {"--strat"});
  expectRefused(2, "--plant pendulum --start", {"--start"});
  expectRefused(2, "--plant pendulum --start 1",
                {"2 finite number(s) (angle_rad,rate_rad_per_s), got \"1\""});
  expectRefused(2, "--plant pendulum --start 1,nan", {"got \"1,nan\""});
  expectRefused(2, "--plant pendulum trajectory.csv", {"trajectory.csv"});
  expectRefused(2, "--plant ./robt.yaml", {"'./robt.yaml': there is no such file"});
  expectRefused(2, "--plant ./robot.urdf", {"new_plant ./robot.urdf"});
  expectRefused(2, "--plant robot.xml", {"new_plant robot.xml"});
}

TEST_F(Simulate, RefusesBadTorquesAndWritesNothing) {
  const fs::path frames = folder_ / "frames";
  const std::string options = "--plant pendulum --frames " + frames.string();
  expectRefused(1, options, {"line 1"}, "");
  expectRefused(1, options, {"line 3"}, "torque_nm\n1\nnan\n");
  EXPECT_FALSE(fs::exists(frames));
}

TEST_F(Simulate, RefusesABadConfigurationFile) {
  const std::string path = (folder_ / "bad.yaml").string();
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"plant: {dt: -1}\n", {"plant/dt"}},
      {"plant: {lenght: 1}\n", {"lenght"}},
      {"plant: {type: cart}\n", {"plant/type", "cart", "moving_tile", "pendulum", "two_link"}}};
  for (const auto& [yaml, words] : cases) {
    std::ofstream(path) << yaml;
    expectRefused(1, "--plant pendulum --config " + path, words);
  }
  expectRefused(1, "--plant pendulum --config /no/such.yaml", {"/no/such.yaml"});
}

TEST_F(Simulate, NoticesWhenItsOutputCannotBeWritten) {
  const Outcome outcome = run("--plant pendulum > /dev/full", "torque_nm\n1\n");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.err, "standard output"));
  EXPECT_EQ(run("--plant pendulum --describe > /dev/full", "").exit_code, 1);
}

}  // namespace
}  // namespace ddm
