// Tests of function calls with a time limit.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <stdexcept>

#include "ddm_common/waiting.h"

namespace ddm {
namespace {

using std::chrono::milliseconds;

TEST(CallWithin, ReturnsWhatTheFunctionReturns) {
  EXPECT_EQ(callWithin(std::chrono::minutes(1), [] { return 7; }), 7);
}

TEST(CallWithin, LeavesBehindWhatDoesNotReturn) {
  std::promise<int> never;
  const std::shared_future<int> future = never.get_future().share();
  EXPECT_EQ(callWithin(milliseconds(10), [future] { return future.get(); }), std::nullopt);
  never.set_value(0);  // the thread ends
}

TEST(CallWithin, PassesExceptionsOn) {
  const auto fail = []() -> int { throw std::runtime_error("as expected"); };
  EXPECT_THROW(callWithin(std::chrono::minutes(1), fail), std::runtime_error);
}

TEST(CallWithin, IsEndedByACheckThatThrows) {
  std::promise<int> never;
  const std::shared_future<int> future = never.get_future().share();
  int num_checks = 0;
  const auto third_time = [&num_checks] {
    if (++num_checks == 3) throw std::runtime_error("shutdown");
  };
  EXPECT_THROW(callWithin(
                   std::chrono::minutes(1), [future] { return future.get(); }, third_time),
               std::runtime_error);
  never.set_value(0);
}

}  // namespace
}  // namespace ddm
