// Stands for a test program of model files where ddm_sim was built without MuJoCo.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

TEST(Mujoco, WasThereWhenThisWasBuilt) { GTEST_SKIP() << "ddm_sim was built without MuJoCo"; }
