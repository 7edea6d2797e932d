// Test of the random streams: one for each purpose, the same in every version.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/random_stream.h"

#include <gtest/gtest.h>

namespace ddm {
namespace {

TEST(RandomStream, DoesNotChangeFromOneVersionToTheNext) {
  const std::uint64_t draws[] = {// published results depend on these draws
                                 2172617572647196348U,  9735909815621124326U, 880987923637700293U,
                                 8837459983291567139U,  4097341192330693964U, 7253929432131995732U,
                                 312604272161489043U,   6020029715130901224U, 9449926314368251004U,
                                 13420142379881102563U, 7218843632006366136U};
  std::uint32_t role = 0;
  for (const std::uint64_t draw : draws) {
    EXPECT_EQ(randomStream({1, 2, false}, static_cast<StreamRole>(++role))(), draw) << role;
  }
  EXPECT_EQ(role, static_cast<std::uint32_t>(StreamRole::kGoal));
}

}  // namespace
}  // namespace ddm
