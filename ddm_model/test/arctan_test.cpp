// Tests of the arctan on whole arrays: accuracy, special values, slope.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "ddm_model/mlp.h"

namespace ddm {
namespace {

template <class Scalar>
class Arctan : public ::testing::Test {
 protected:
  /// Both signs, from the smallest normal number to the largest, and densely where arctan bends.
  static std::vector<Scalar> wholeRange() {
    std::vector<Scalar> x;
    for (int i = -40000; i <= 40000; ++i) x.push_back(static_cast<Scalar>(i * 1e-4));
    const int top = std::numeric_limits<Scalar>::max_exponent;
    for (int exponent = std::numeric_limits<Scalar>::min_exponent; exponent < top; ++exponent) {
      for (double mantissa : {0.5, 0.6180339887, 0.9999}) {
        const Scalar value = std::ldexp(static_cast<Scalar>(mantissa), exponent);
        x.push_back(value);
        x.push_back(-value);
      }
    }
    return x;
  }

  struct Result {
    std::vector<Scalar> y, slope;
  };
  static Result evaluate(const std::vector<Scalar>& x) {
    Result out{x, std::vector<Scalar>(x.size())};
    arctan(out.y.data(), out.slope.data(), static_cast<Eigen::Index>(x.size()));
    return out;
  }

  static constexpr bool kIsFloat = sizeof(Scalar) == sizeof(float);
  static constexpr long double kTolerance = kIsFloat ? 3e-7L : 5e-16L;
};

using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Arctan, Scalars, );

TYPED_TEST(Arctan, StaysWithinItsDocumentedErrorOverTheWholeRange) {
  const auto x = TestFixture::wholeRange();
  const auto result = TestFixture::evaluate(x);
  for (size_t i = 0; i < x.size(); ++i) {
    const long double error =
        std::abs(static_cast<long double>(result.y[i]) - std::atan(static_cast<long double>(x[i])));
    ASSERT_LE(error, TestFixture::kTolerance) << "x = " << x[i];
    const long double wide = x[i];
    ASSERT_NEAR(result.slope[i], static_cast<double>(1.0L / (1.0L + wide * wide)),
                TestFixture::kTolerance)
        << "x = " << x[i];
  }
}

TYPED_TEST(Arctan, KeepsSpecialValues) {
  const TypeParam inf = std::numeric_limits<TypeParam>::infinity();
  const TypeParam nan = std::numeric_limits<TypeParam>::quiet_NaN();
  const auto result = TestFixture::evaluate({inf, -inf, nan, TypeParam(-0.0), TypeParam(0.0)});
  EXPECT_EQ(result.y[0], static_cast<TypeParam>(std::acos(0.0)));
  EXPECT_EQ(result.y[1], -static_cast<TypeParam>(std::acos(0.0)));
  EXPECT_EQ(result.slope[0], TypeParam(0));
  EXPECT_EQ(result.slope[1], TypeParam(0));
  EXPECT_TRUE(std::isnan(result.y[2]));
  EXPECT_TRUE(std::isnan(result.slope[2]));
  EXPECT_TRUE(result.y[3] == 0 && std::signbit(result.y[3]));
  EXPECT_TRUE(result.y[4] == 0 && !std::signbit(result.y[4]));
  EXPECT_EQ(result.slope[4], TypeParam(1));
}

// Whole packets of values and what is left over are computed alike.
TYPED_TEST(Arctan, TreatsEachValueAlikeWhateverTheirNumber) {
  const auto x = TestFixture::wholeRange();
  for (size_t n : {0, 1, 3, 7, 64, 65}) {
    const auto some = TestFixture::evaluate({x.begin(), x.begin() + static_cast<int>(n)});
    for (size_t i = 0; i < n; ++i) {
      const auto alone = TestFixture::evaluate({x[i]});
      EXPECT_EQ(some.y[i], alone.y[0]) << "value " << i << " of " << n;
      EXPECT_EQ(some.slope[i], alone.slope[0]) << "value " << i << " of " << n;
    }
  }
}

}  // namespace
}  // namespace ddm
