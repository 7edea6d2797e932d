// Tests that sums are rounded alike on all processors that run the same build.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Core>

namespace ddm {
namespace {

#ifdef __x86_64__
TEST(Rounding, DoesNotDependOnTheCachesOfThisProcessor) {
  // Eigen splits the sums in matrix products by these sizes.
  EXPECT_EQ(Eigen::l1CacheSize(), 32 * 1024);
  EXPECT_EQ(Eigen::l2CacheSize(), 256 * 1024);
  EXPECT_EQ(Eigen::l3CacheSize(), 2 * 1024 * 1024);
}
#endif

}  // namespace
}  // namespace ddm
