// Tests of drawing in processes of their own: equal bytes, and a name for each failure.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/run_program.h>
#include <gtest/gtest.h>

#include <string>

namespace ddm {
namespace {

using testing::Outcome;

/// @param setting    shell words in front of the command: assignments, or `unset ...;`
/// @param arguments  after the scene: ANGLE SIZE SAMPLES
Outcome draw(const std::string& setting, const std::string& arguments) {
  return testing::run(setting + " " DDM_MUJOCO_DRAW_ONCE " " DDM_MUJOCO_TEST_SCENE " " + arguments);
}

void expectNamed(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

TEST(DrawingProcesses, GiveTheSameBytes) {
  const Outcome first = draw("", "0.4 51 4");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out.size(), std::size_t{2 * 3 * 51 * 51});
  for (const char* setting : {"", "LP_NUM_THREADS=0", "LP_NUM_THREADS=1", "LP_NUM_THREADS=3"}) {
    EXPECT_EQ(draw(setting, "0.4 51 4").out, first.out) << setting;
  }
  EXPECT_NE(draw("", "0.5 51 4").out, first.out);
}

TEST(DrawingProcesses, NeedNoScreen) {
  const Outcome outcome = draw("unset DISPLAY WAYLAND_DISPLAY XDG_RUNTIME_DIR;", "0.4 51 0");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(draw("DISPLAY=:99", "0.4 51 0").out, outcome.out);
}

TEST(DrawingProcesses, NameEglWhereItIsMissing) {
  const char* const no_vendor = "__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null";
  expectNamed(draw(no_vendor, "0 51 0"), "eglGetPlatformDisplayEXT");
  expectNamed(draw(no_vendor, "0 51 0"), "libgl1-mesa-dri");
  expectNamed(draw("LIBGL_DRIVERS_PATH=/nowhere GALLIUM_DRIVER=nothing", "0 51 0"),
              "eglInitialize");
}

}  // namespace
}  // namespace ddm
