// Replaces the tests of model files if ddm_sim is built without MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

TEST(Mujoco, WasThereWhenThisWasBuilt) { GTEST_SKIP() << "ddm_sim was built without MuJoCo"; }
