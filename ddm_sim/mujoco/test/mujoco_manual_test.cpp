// Test of config/mujoco_pendulum.yaml as the manual of plants `type: mujoco`.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "ddm_mujoco/mujoco_options.h"

namespace ddm {
namespace {

TEST(MujocoManual, NamesEveryKeyOnceWithItsDefaultButForWhatThePendulumNeeds) {
  const YAML::Node manual =
      YAML::LoadFile(DDM_SIM_SOURCE_DIR "/config/mujoco_pendulum.yaml")["plant"];
  const std::set<std::string> of_the_pendulum = {
      "model",         "max_torque",  "start",        "goal",   "tolerance",
      "visible_sites", "state_names", "torque_names", "camera", "supersampling"};
  ParamReader reader = ParamReader::fromFiles({DDM_SIM_SOURCE_DIR "/config/mujoco_pendulum.yaml"});
  const YAML::Node read = toYaml(reader.read<MujocoOptions>("plant"));
  ASSERT_NO_THROW(reader.requireValid());
  const YAML::Node defaults = toYaml(MujocoOptions());
  EXPECT_EQ(manual.size(), defaults.size());
  for (const auto& entry : defaults) {
    const auto key = entry.first.as<std::string>();
    EXPECT_TRUE(manual[key].IsDefined()) << key;
    EXPECT_EQ(YAML::Dump(read[key]) == YAML::Dump(entry.second), of_the_pendulum.count(key) == 0)
        << key << " of the manual is " << YAML::Dump(read[key]);
  }
}

}  // namespace
}  // namespace ddm
