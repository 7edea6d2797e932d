// Tests of the strict configuration reader: types, unknown blocks, damaged and unusual files.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/param_reader.h"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_common/config_blocks.h"
#include "ddm_common/image_options.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/temp_folder.h"

namespace ddm {
namespace {

struct MpcOptions {
  int horizon = 15;
  double epsilon = 0.2;
  bool warm_start = true;
  std::string goal_image = "up";
  std::vector<int> starts = {1, 2};
  std::vector<double> start_scale = {0.5};

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("horizon", horizon);
    visitor("epsilon", epsilon);
    visitor("warm_start", warm_start);
    visitor("goal_image", goal_image);
    visitor("starts", starts);
    visitor("start_scale", start_scale);
  }

  std::vector<std::string> problems() const { return {}; }
};

struct TrialOptions {
  int num_steps = 100;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("num_steps", num_steps);
  }
  std::vector<std::string> problems() const { return {}; }
};

ParamReader readerOf(const std::string& yaml) { return ParamReader(YAML::Load(yaml)); }

/// All problems of the block `mpc` in a YAML text.
std::vector<std::string> mpcProblems(const std::string& yaml) {
  ParamReader reader = readerOf(yaml);
  reader.read<MpcOptions>("mpc");
  return reader.problems();
}

/// A file that is gone when the test ends.
class ScratchFile {
 public:
  ScratchFile(const std::string& name, const std::string& text) : path_(folder_.file(name)) {
    std::ofstream(path_) << text;
  }
  const std::string& path() const { return path_; }

 private:
  const testing::TempFolder folder_;
  const std::string path_;
};

TEST(ParamReader, GivesDefaultsWhereTheConfigurationIsSilent) {
  for (const char* yaml : {"", "{}", "mpc:", "mpc: {}"}) {
    ParamReader reader = readerOf(yaml);
    const auto options = reader.read<MpcOptions>("mpc");
    EXPECT_EQ(YAML::Dump(toYaml(options)), YAML::Dump(toYaml(MpcOptions()))) << yaml;
    EXPECT_NO_THROW(reader.requireValid()) << yaml;
  }
  EXPECT_NO_THROW(ParamReader(YAML::Node()).requireValid());
}

TEST(ParamReader, NamesTheExpectedTypeOfEveryKey) {
  const auto problems = mpcProblems(
      "mpc: {horizon: ~, epsilon: high, warm_start: yes, goal_image: [], "
      "starts: [1, 2.5], start_scale: {a: 1}}");
  const std::vector<std::vector<std::string>> parts = {
      {"mpc/horizon", "integer", "got nothing"},
      {"mpc/epsilon", "number", "got high"},
      {"mpc/warm_start", "true", "got yes"},
      {"mpc/goal_image", "text", "got []"},
      {"mpc/starts", "list", "integer", "got [1, 2.5]"},
      {"mpc/start_scale", "number", "list", "got {a: 1}"}};
  ASSERT_EQ(problems.size(), parts.size());
  for (size_t i = 0; i < parts.size(); ++i) EXPECT_TRUE(testing::names(problems[i], parts[i]));
}

TEST(ParamReader, PutsAWrongValueOfSeveralLinesInOne) {
  const auto problems = mpcProblems("mpc: {horizon: \"1\\n2\\e[0m\"}");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(testing::names(problems[0], {"mpc/horizon", "got 1 2 [0m"}));
}

TEST(ParamReader, ReportsABlockThatIsNoMap) {
  for (const std::string value : {"5", "[1]"}) {
    const auto problems = mpcProblems("mpc: " + value);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_TRUE(testing::names(problems[0], {"mpc", "got " + value}));
  }
}

TEST(ParamReader, LeavesBlocksOfOtherProgramsAloneAndNamesThemWhereABlockIsUnknown) {
  EXPECT_EQ(mpcProblems("{plant: 1, camera: 1, robot: 1, version: 2, mpc: {horizon: 3}}"),
            std::vector<std::string>());
  ASSERT_EQ(mpcProblems("my_robot: 1").size(), 1u);
  EXPECT_TRUE(testing::names(mpcProblems("my_robot: 1")[0],
                             {" my_robot ", "camera", "model", "mpc", "plant", "robot"}));
}

TEST(ParamReaderFiles, LeavesNamesAndValuesOfOtherTypesAsTheyAre) {
  const ScratchFile file("names.yaml",
                         "experiment: {plant: pendulum}\nplant: {model: \"\"}\nstart: {bags: []}");
  EXPECT_EQ(YAML::Dump(readBlocks(file.path())),
            "experiment: {plant: pendulum}\nplant: {model: \"\"}\nstart: {bags: []}");
}

TEST(ParamReaderFiles, KeepsABlockThatALaterFileLeavesEmpty) {
  const ScratchFile manual("manual.yaml", "mpc: {horizon: 25}");
  const ScratchFile preset("preset.yaml", "mpc:\n  # nothing differs\n");
  ParamReader reader = ParamReader::fromFiles({manual.path(), preset.path()});
  EXPECT_EQ(reader.read<MpcOptions>("mpc").horizon, 25);
}

TEST(ParamReaderFiles, OverridesOneUserOfAnAnchorOnly) {
  const ScratchFile shared("shared.yaml", "mpc: &same {num_steps: 5}\ntrial: *same");
  const ScratchFile later("later.yaml", "mpc: {num_steps: 6}");
  ParamReader reader = ParamReader::fromFiles({shared.path(), later.path()});
  EXPECT_EQ(reader.read<TrialOptions>("mpc").num_steps, 6);
  EXPECT_EQ(reader.read<TrialOptions>("trial").num_steps, 5);
}

TEST(ParamReaderFiles, RefusesAFileThatIsTooLargeToBeAConfiguration) {
  const ScratchFile file("large.yaml", "#" + std::string(1000000, 'x'));
  EXPECT_TRUE(testing::throwsNaming<std::runtime_error>(
      [&file] { ParamReader::fromFiles({file.path()}); }, {file.path(), "1000000 bytes"}));
}

TEST(ParamReaderFiles, RefusesBadFilesWithPathAndLine) {
  struct Case {
    std::string yaml, line, part;
  };
  for (const Case& bad :
       std::vector<Case>{{"mpc:\n  horizon: [1, 2\ntrial: {\n", ":3: ", "valid YAML"},
                         {"\n- mpc\n- trial\n", ":2: ", " map "},
                         {"just text", ":1: ", "got just text"},
                         {"mpc: {horizon: 1}\n---\nmpc: {horizon: 2}\n", ":2: ", "document"},
                         {"mpc: {horizon: 1}\ntrial:\nmpc: {horizon: 2}\n", ":3: ", "'mpc'"},
                         {"mpc:\n  horizon: 1\n  epsilon: 0\n  horizon: 2\n", ":4: ", "'horizon'"},
                         {"mpc: {[1, 2]: 3}\n", ":1: ", "plain name"}}) {
    const ScratchFile file("bad.yaml", bad.yaml);
    EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
        [&file] { ParamReader::fromFiles({file.path()}); }, {file.path() + bad.line, bad.part}))
        << bad.yaml;
  }
}

TEST(ImageOptions, TheSizeHasARange) {
  EXPECT_EQ(ImageOptions().size, 51);
  for (const int size : {4, 1024}) EXPECT_TRUE(ImageOptions{size}.problems().empty()) << size;
  for (const int size : {3, 1025}) {
    const std::vector<std::string> problems = ImageOptions{size}.problems();
    ASSERT_EQ(problems.size(), 1u) << size;
    EXPECT_TRUE(testing::names(problems[0], {"image/size must ", ", got " + std::to_string(size)}));
  }
}

}  // namespace
}  // namespace ddm
