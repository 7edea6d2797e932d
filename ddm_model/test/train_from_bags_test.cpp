// Tests of train_from_bags as a user calls it: files in, files and exit code out.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "ddm_common/plain_file.h"
#include "ddm_model/model_file.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/run_program.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "toy_bags.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::contains;
using testing::Outcome;

class TrainFromBags : public ::testing::Test {
 protected:
  TrainFromBags() {
    testing::writeTrial(path("a.bag"), testing::toyTrial(30, 1));
    testing::writeTrial(path("b.bag"), testing::toyTrial(30, 2));
    testing::writeTrial(path("goalless.bag"), testing::toyTrial(30, 3), /*with_goal=*/false);
    write("toy.yaml",
          "image: {size: 8}\n"
          "model: {pca_dim: 6, encoder_widths: [5]}\n"
          "training: {max_iterations: 10}\n");
  }

  std::string path(const std::string& name) const { return folder_.file(name); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }

  /// Runs the tool in the folder of the test.
  /// @param setup  commands of a shell, before the program starts
  Outcome run(const std::string& arguments, const std::string& setup = "") const {
    return testing::run("cd " + folder_.file("") + " && " + setup + DDM_MODEL_TRAIN_FROM_BAGS +
                        " " + arguments);
  }
  Outcome train(const std::string& arguments, const std::string& setup = "") const {
    return run("--config toy.yaml --out new.model " + arguments, setup);
  }
  Ddm model() const { return deserialiseModel(readFile(path("new.model")), "new.model"); }

  const testing::TempFolder folder_;
};

TEST_F(TrainFromBags, WritesAModelOfAllBags) {
  const Outcome outcome = train("--seed 7 a.bag b.bag");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(model().info().frames, 60U);
  EXPECT_EQ(model().info().seed, 7U);
  EXPECT_EQ(model().info().trial, 1U);
  EXPECT_EQ(model().goal(), testing::toyImage(3.0));
  EXPECT_TRUE(contains(outcome.out, "id: " + modelId(readFile(path("new.model"))))) << outcome.out;
  EXPECT_TRUE(contains(outcome.out, "frames: 60\nsegments: 2\ngoal: yes\n")) << outcome.out;
  EXPECT_TRUE(contains(model().info().config, "max_iterations: 10"));
}

TEST_F(TrainFromBags, GivesTheSameModelForTheSameSeedOnly) {
  ASSERT_EQ(train("--seed 1 a.bag").exit_code, 0);
  const std::string first = readFile(path("new.model"));
  ASSERT_EQ(train("--seed 1 a.bag").exit_code, 0);
  EXPECT_EQ(readFile(path("new.model")), first);
  ASSERT_EQ(train("--seed 2 a.bag").exit_code, 0);
  EXPECT_NE(readFile(path("new.model")), first);
}

TEST_F(TrainFromBags, TakesTheLimitsOfItsMotorsFromTheRobotOrThePlantAndTellsWhich) {
  write("plant.yaml", "plant: {type: pendulum, max_torque: 3.0}\n");
  write("robot.yaml", "robot: {max_torque: 2.0}\n");
  write("model.yaml", "model: {max_torque: 5.0}\n");
  const auto limitAndKey = [this](const std::string& configs) {
    const Outcome outcome = train(configs + " a.bag");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::size_t begin = outcome.out.find("max_torque_from: ") + 17;
    return std::make_pair(model().options().max_torque,
                          outcome.out.substr(begin, outcome.out.find('\n', begin) - begin));
  };
  using Limits = std::vector<double>;
  EXPECT_EQ(limitAndKey(""), std::make_pair(Limits{6.0}, std::string("the default")));
  EXPECT_EQ(limitAndKey("--config plant.yaml"),
            std::make_pair(Limits{3.0}, std::string("plant/max_torque")));
  EXPECT_EQ(limitAndKey("--config plant.yaml --config robot.yaml"),
            std::make_pair(Limits{2.0}, std::string("robot/max_torque")));
  EXPECT_EQ(limitAndKey("--config model.yaml --config robot.yaml"),
            std::make_pair(Limits{5.0}, std::string("model/max_torque")));
  EXPECT_FALSE(contains(train("a.bag").err, "largest torque"));
  EXPECT_TRUE(
      testing::names(train("--set model/max_torque=0.01 a.bag").err,
                     {"largest torque of motor 0", "limit is 0.01 N m (model/max_torque)"}));
  write("file.yaml",
        "plant: {type: mujoco, model: robot.xml}\n");  // which may know; this tool does not
  const Outcome outcome = train("--config file.yaml a.bag");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("plant/max_torque"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("robot.xml"), std::string::npos) << outcome.err;
  EXPECT_EQ(limitAndKey("--config file.yaml --config model.yaml").second, "model/max_torque");
}

TEST_F(TrainFromBags, TakesTheGoalFromAnImageFileAndCropsIt) {
  std::string pixels;
  for (int i = 0; i < 16 * 16; ++i) pixels += std::to_string(10 * (i % 16)) + " ";
  write("goal.pgm", "P2\n16 16\n255\n" + pixels + "\n");
  ASSERT_EQ(train("--crop 4,2,8,8 --goal goal.pgm a.bag").exit_code,
            0);  // wins over that of the bag
  EXPECT_EQ(model().goal()[0], 40);
  EXPECT_EQ(model().goal()[7], 110);
}

TEST_F(TrainFromBags, SaysWhereThereIsNoGoal) {
  const Outcome outcome = train("goalless.bag");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(testing::names(outcome.err, {"--goal", "goal_image"}));
  EXPECT_TRUE(contains(outcome.out, "goal: none"));
  EXPECT_FALSE(model().hasGoal());
}

TEST_F(TrainFromBags, RefusesACommandLineThatMakesNoSense) {
  const auto refused = [this](const std::string& arguments, const std::vector<std::string>& parts) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_TRUE(testing::names(outcome.err, parts));
    EXPECT_TRUE(contains(outcome.err, "--help")) << outcome.err;
  };
  refused("--out new.model --sede 1 a.bag", {"--sede"});
  refused("--out new.model --seed -1 a.bag", {"--seed", ">= 0", "got -1"});
  refused("--out new.model --seed one a.bag", {"one"});
  refused("--out new.model --seed 1 --seed 2 a.bag", {"--seed"});
  refused("--out new.model", {"bag", "required"});
  refused("a.bag", {"--out", "required"});
  EXPECT_FALSE(fs::exists(path("new.model")));
}

TEST_F(TrainFromBags, RefusesAConfigurationWithMistakesAndNamesThem) {
  EXPECT_EQ(train("--config missing.yaml a.bag").exit_code, 1);
  const Outcome options = train("--dt often --crop 1,2 --image-topic / a.bag");
  EXPECT_EQ(options.exit_code, 1);
  EXPECT_TRUE(testing::names(options.err, {"data_set/dt", "a number", "often"}));
  EXPECT_TRUE(testing::names(options.err, {"data_set/crop", "[1, 2]"}));
  EXPECT_TRUE(testing::names(options.err, {"data_set/image_topic", "'/'"}));
  EXPECT_FALSE(fs::exists(path("new.model")));
}

TEST_F(TrainFromBags, RefusesAModelThatItCannotWriteAndAGoalThatItCannotReadBeforeItReadsBags) {
  const Outcome model = run("--config toy.yaml --out no_folder/new.model missing.bag");
  EXPECT_EQ(model.exit_code, 1);
  EXPECT_TRUE(testing::names(model.err, {"cannot write no_folder/new.model", "No such file"}));
  EXPECT_TRUE(testing::names(train("--goal goal.png missing.bag").err,
                             {"cannot read goal.png", "No such file"}));
}

TEST_F(TrainFromBags, LeavesTheOldModelWhereTheNewOneCannotBeWritten) {
  write("new.model", "old");
  const Outcome outcome = train("a.bag", "trap '' XFSZ && ulimit -f 2 && ");  // like a full disk
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(testing::names(outcome.err, {"write", "new.model"}));
  EXPECT_EQ(readFile(path("new.model")), "old");
}

}  // namespace
}  // namespace ddm
