// Tests of the parameters of images.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/image_options.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace ddm {
namespace {

TEST(ImageOptions, TheSizeHasARange) {
  EXPECT_EQ(ImageOptions().size, 51);
  for (const int size : {4, 51, 1024}) EXPECT_TRUE(ImageOptions{size}.problems().empty()) << size;
  for (const int size : {3, 1025}) {
    const std::vector<std::string> problems = ImageOptions{size}.problems();
    ASSERT_EQ(problems.size(), 1u) << size;
    EXPECT_EQ(problems[0].rfind("image/size must ", 0), 0u) << problems[0];
    EXPECT_NE(problems[0].find(", got " + std::to_string(size)), std::string::npos) << problems[0];
  }
}

}  // namespace
}  // namespace ddm
